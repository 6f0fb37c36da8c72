// The page of runs under way: asks its server a few times a second, says what has finished, draws what runs.

import { drawRunning, pictureOf, windowOfMap } from "arena/live_view.js";
import { standing } from "arena/live_words.js";

/** @typedef {import("./live_words.js").Run} Run */
/** @typedef {import("./live_words.js").State} State */

const [QUICK, SLOW] = [300, 1000]; // ms between two questions, while episodes run and else
const element = (/** @type {string} */ name) => /** @type {HTMLElement} */ (document.getElementById(name));
const token = new URLSearchParams(location.search).get("token") ?? "";
/** @type {Map<string, any>} worlds by run and grid; null while they are fetched */
const worlds = new Map();
let shown = "";

/** @param {string} path @param {Record<string, string | number>} words */
const address = (path, words) => {
  const texts = Object.fromEntries(Object.entries(words).map(([key, value]) => [key, String(value)]));
  return `${path}?${new URLSearchParams({ ...texts, token })}`;
};

/** @param {Run} run @param {string} grid */
function worldOf(run, grid) {
  const key = `${run.number} ${grid}`;
  if (!worlds.has(key)) {
    worlds.set(key, null);
    fetch(address("map", { run: run.number, grid }))
      .then((answer) => answer.json())
      .then((map) => worlds.set(key, { map, picture: pictureOf(map, document.body), window: windowOfMap(map) }))
      .catch(() => worlds.delete(key));
  }
  return worlds.get(key);
}

/** @param {State} state */
function showRunning(state) {
  const list = element("running");
  const running = state.runs.flatMap((run) => run.running.map((one) => ({ run, one })));
  while (list.children.length > running.length) list.lastChild?.remove();
  while (list.children.length < running.length) {
    const item = list.appendChild(document.createElement("li"));
    item.append(document.createElement("canvas"), document.createElement("div"));
  }
  running.forEach(({ run, one }, place) => {
    const [canvas, text] = list.children[place].children;
    text.textContent = `${run.name}, episode ${one.episode}: ${one.stamp.toFixed(1)} s of ${one.time_limit} s`;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `episode ${one.episode} from above`);
    drawRunning(/** @type {HTMLCanvasElement} */ (canvas), one, worldOf(run, one.grid));
  });
  element("hint").hidden = running.length > 0 || state.done === state.total;
}

/** @param {State} state */
function showFinished(state) {
  const rows = state.runs.flatMap((run) => run.rows.map((row) => ({ run, row }))).reverse();
  const now = JSON.stringify(rows.map(({ run, row }) => [run.number, row.episode, row.outcome]));
  if (now === shown) return;
  shown = now;
  element("finished").replaceChildren(
    ...rows.map(({ run, row }) => {
      const line = document.createElement("tr");
      const ended =
        row.error ||
        `${row.outcome.replaceAll("_", " ")}${Number(row.collisions) ? `, ${row.collisions} collisions` : ""}`;
      for (const text of [
        run.name,
        row.episode,
        row.preset,
        row.robot,
        row.world,
        ended,
        row.time_to_goal && Number(row.time_to_goal).toFixed(1),
      ]) {
        line.appendChild(document.createElement("td")).textContent = text;
      }
      if (!["1", "1.0"].includes(row.success)) line.children[5].className = "bad";
      const link = line.appendChild(document.createElement("td")).appendChild(document.createElement("a"));
      link.href = address("replay", { run: run.number, episode: row.episode });
      link.target = "_blank";
      link.textContent = "watch";
      return line;
    }),
  );
}

async function look() {
  let wait = SLOW;
  try {
    const answer = await fetch(address("state", {}));
    if (!answer.ok) throw new Error(await answer.text());
    const state = /** @type {State} */ (await answer.json());
    element("standing").textContent = standing(state);
    element("progress").setAttribute("value", String(state.total ? state.done / state.total : 0));
    showRunning(state);
    showFinished(state);
    if (state.runs.some((run) => run.running.length)) wait = QUICK;
  } catch (error) {
    element("standing").textContent =
      `the server does not answer (${error instanceof Error ? error.message : error}); trying again`;
  }
  setTimeout(look, wait);
}

look();
