// The preview: the server simulates the scene for some seconds, and the viewer's scene plays what moved over the same
// map.

import { bytesOf, decode, unpack } from "arena/decode.js";
import { Episode } from "arena/episode.js";
import { Player } from "arena/player.js";
import { Scene } from "arena/scene.js";
import { button, choice, make } from "studio/shell/forms.js";

/** @typedef {import("./editor.js").Editor} Editor */

const SECONDS = ["10", "20", "40", "60"];
const OUTCOMES = /** @type {Record<string, string>} */ ({
  goal_reached: "the robot reached its goal",
  time_out: "the robot is still on its way",
  collision: "a collision ended it",
  error: "an error ended it",
});
const LAYERS = {
  path: true,
  trail: true,
  lidar: true,
  people: true,
  estimate: false,
  tracks: false,
  considered: false,
};

export class Preview {
  /**
   * @param {Editor} editor
   * @param {HTMLCanvasElement} canvas that the editor's view draws on
   * @param {() => void} changed draws again
   */
  constructor(editor, canvas, changed) {
    this.editor = editor;
    this.canvas = canvas;
    this.changed = changed;
    /** @type {Scene | null} */ this.scene = null; // what is played
    this.player = new Player(0, 0.1);
    this.at = -1; // number of the scene of the file that was simulated
    this.frame = 0;
    this.layers = { ...LAYERS };
    this.legs = false;
    this.planner = editor.kinds.planner.includes("pure_pursuit") ? "pure_pursuit" : editor.kinds.planner[0];
    this.seconds = "20";
    this.dark = matchMedia("(prefers-color-scheme: dark)");
    this.dark.addEventListener("change", this.recolour);
    this.said = make("span", { className: "soft", role: "status" });
    this.start = button("Preview", () => void editor.trying(() => this.ask()), { className: "main" });
    this.pause = button("Play", () => this.toggle(), { hidden: true });
    this.slider = make("input", {
      type: "range",
      min: "0",
      step: "any",
      value: "0",
      hidden: true,
      "aria-label": "time of the preview, s",
    });
    this.slider.addEventListener("input", () => this.player.seek(Number(this.slider.value)));
    this.end = button("End preview", () => this.stop(), { hidden: true });
    this.beams = tick("lidar", true, (on) => {
      this.layers.lidar = on;
      this.changed();
    });
    this.beams.hidden = true;
  }

  /** @returns {HTMLElement} */
  bar() {
    const { robot, planner, pedestrians } = this.editor.kinds;
    const choose = (
      /** @type {string} */ name,
      /** @type {string[]} */ options,
      /** @type {string} */ value,
      /** @type {(value: string) => void} */ act,
    ) => make("label", { className: "inline" }, `${name} `, choice(options, value, act));
    const choices = make(
      "div",
      { className: "row" },
      this.start,
      choose("robot", robot, this.editor.robotName, (value) => this.#other({ robotName: value })),
      choose("planner", planner, this.planner, (value) => void (this.planner = value)),
      choose("people", pedestrians, this.editor.people, (value) => this.#other({ people: value })),
      tick("legs", this.legs, (on) => void (this.legs = on), "people walk on legs, which the lidar sees"),
      choose("for, s", SECONDS, this.seconds, (value) => void (this.seconds = value)),
    );
    return make(
      "div",
      { className: "preview" },
      choices,
      make("div", { className: "row played" }, this.beams, this.pause, this.slider, this.end, this.said),
    );
  }

  /** @param {Partial<Editor>} change */
  #other(change) {
    Object.assign(this.editor, change);
    void this.editor.check();
  }

  async ask() {
    const { editor } = this;
    if (!editor.content) return;
    this.stop();
    this.start.disabled = true;
    this.said.textContent = "simulating … (what is used for the first time is compiled, which takes a minute)";
    try {
      const asked = {
        ...editor.asked,
        scene: editor.at,
        planner: this.planner,
        seconds: Number(this.seconds),
        legs: this.legs,
      };
      const answer = await editor.context.api.post("/api/scenarios/preview", asked);
      const { maps, episodes } = decode(await unpack(bytesOf(answer.document)));
      this.#play(new Episode(episodes[0], maps), asked.scene);
      this.said.textContent = this.said.title = answer.error || OUTCOMES[answer.outcome] || answer.outcome;
    } catch (error) {
      this.said.textContent = "";
      throw error;
    } finally {
      this.start.disabled = false;
    }
  }

  /** @param {Episode} episode @param {number} at */
  #play(episode, at) {
    this.scene = new Scene(this.canvas, [episode]);
    this.at = at;
    this.player = new Player(episode.end, episode.said.robot.period);
    this.player.listen(() => this.#told());
    this.slider.max = String(episode.end);
    this.#shown(true);
    this.player.seek(0);
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) this.toggle();
  }

  #told() {
    const { time, playing } = this.player;
    this.slider.value = String(time);
    this.slider.title = `${time.toFixed(1)} s`;
    this.pause.textContent = playing ? "Stop" : "Play";
    this.changed();
  }

  /** @param {boolean} shown */
  #shown(shown) {
    for (const element of [this.beams, this.pause, this.slider, this.end]) element.hidden = !shown;
  }

  toggle() {
    cancelAnimationFrame(this.frame);
    this.player.toggle();
    if (this.player.playing) this.#run(this.player, performance.now());
  }

  /** Let a player go on, frame by frame, until it stops. @param {Player} player @param {number} before ms */
  #run(player, before) {
    this.frame = requestAnimationFrame((now) => {
      player.advance(Math.max(now - before, 0) / 1000);
      if (player.playing) this.#run(player, now);
    });
  }

  stop() {
    cancelAnimationFrame(this.frame);
    this.player.playing = false;
    this.scene = null;
    this.said.textContent = "";
    this.#shown(false);
    this.changed();
  }

  recolour = () => {
    this.scene?.recolour();
    this.changed();
  };

  close() {
    this.dark.removeEventListener("change", this.recolour);
    this.stop();
  }

  /** Whether something is played over the scene that the editor shows. */
  get isShown() {
    return this.scene !== null && this.at === this.editor.at;
  }

  /** Draw in metres. @param {number} scale pixels a metre */
  draw(scale) {
    if (this.isShown) this.scene?.moving([0], scale, this.player.time, this.layers);
  }
}

/** @param {string} text @param {boolean} checked @param {(on: boolean) => void} act @param {string} [title] */
function tick(text, checked, act, title = "") {
  const box = make("input", { type: "checkbox", checked });
  box.addEventListener("change", () => act(box.checked));
  return make("label", { className: "inline", title }, box, text);
}
