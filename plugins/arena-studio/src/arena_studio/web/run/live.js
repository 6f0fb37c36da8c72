// What the server tells of the experiments, over a websocket that is opened again whenever it breaks.

const AGAIN = [500, 1000, 2000, 5000]; // ms until the next try; the last one from then on

/**
 * @typedef {object} Experiment
 * @property {string} name
 * @property {"running" | "stopping" | "finished" | "refused" | "cut off"} state
 * @property {string} folder
 * @property {string[]} folders of its jobs
 * @property {string} command
 * @property {string} began
 * @property {number} jobs
 * @property {number} done
 * @property {number} episodes
 * @property {number | null} left s
 * @property {number} workers
 * @property {number | null} status
 * @property {string[]} said
 * @property {Record<string, any>[]} last
 */

/**
 * Listen until the returned function is called.
 * @param {(experiments: Experiment[]) => void} told
 * @param {(connected: boolean) => void} connected
 */
export function listen(told, connected) {
  let tries = 0;
  let timer = 0;
  let over = false;
  /** @type {WebSocket | null} */ let socket = null;

  function open() {
    socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/api/live`);
    socket.onmessage = (event) => {
      tries = 0;
      connected(true);
      told(JSON.parse(event.data).experiments);
    };
    socket.onclose = () => {
      if (over) return;
      connected(false);
      timer = window.setTimeout(open, AGAIN[Math.min(tries++, AGAIN.length - 1)]);
    };
  }

  open();
  return () => {
    over = true;
    window.clearTimeout(timer);
    socket?.close();
  };
}
