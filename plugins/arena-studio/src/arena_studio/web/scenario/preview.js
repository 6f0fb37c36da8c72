// The preview: the server simulates the scene for some seconds, and what moved is played over the same map.

import { bytesOf, decode, unpack } from "arena/decode.js";
import { Episode } from "arena/episode.js";
import { drawRobot } from "studio/scenario/drawing.js";
import { ROBOT, faded } from "studio/scenario/looks.js";
import { button, choice, make } from "studio/shell/forms.js";

/** @typedef {import("./editor.js").Editor} Editor */

const SECONDS = ["10", "20", "40", "60"];
const OUTCOMES = /** @type {Record<string, string>} */ ({ goal_reached: "the robot reached its goal", time_out: "the robot is still on its way", collision: "a collision ended it", error: "an error ended it" });

export class Preview {
  /** @param {Editor} editor @param {() => void} changed draws anew */
  constructor(editor, changed) {
    this.editor = editor;
    this.changed = changed;
    /** @type {Episode | null} */ this.episode = null;
    this.time = 0;
    this.playing = false;
    this.last = 0;
    this.scene = -1;
    this.planner = editor.kinds.planner.includes("pure_pursuit") ? "pure_pursuit" : editor.kinds.planner[0];
    this.seconds = "20";
    this.said = make("span", { className: "soft", role: "status" });
    this.start = button("Preview", () => void editor.trying(() => this.ask()), { className: "main" });
    this.pause = button("Play", () => this.toggle(), { hidden: true });
    this.slider = make("input", { type: "range", min: "0", step: "any", value: "0", hidden: true, "aria-label": "time of the preview, s" });
    this.slider.addEventListener("input", () => this.seek(Number(this.slider.value)));
    this.end = button("End preview", () => this.stop(), { hidden: true });
  }

  /** @returns {HTMLElement} */
  bar() {
    const { robot, planner, pedestrians } = this.editor.kinds;
    const choose = (/** @type {string} */ name, /** @type {string[]} */ options, /** @type {string} */ value, /** @type {(value: string) => void} */ act) =>
      make("label", { className: "inline" }, `${name} `, choice(options, value, act));
    return make(
      "div",
      { className: "preview row" },
      this.start,
      choose("robot", robot, this.editor.robotName, (value) => this.#other({ robotName: value })),
      choose("planner", planner, this.planner, (value) => void (this.planner = value)),
      choose("people", pedestrians, this.editor.people, (value) => this.#other({ people: value })),
      choose("for, s", SECONDS, this.seconds, (value) => void (this.seconds = value)),
      this.pause,
      this.slider,
      this.end,
      this.said,
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
      const asked = { ...editor.asked, scene: editor.at, planner: this.planner, seconds: Number(this.seconds) };
      const answer = await editor.context.api.post("/api/scenarios/preview", asked);
      const { maps, episodes } = decode(await unpack(bytesOf(answer.document)));
      this.episode = new Episode(episodes[0], maps);
      this.scene = editor.at;
      this.said.textContent = answer.error || OUTCOMES[answer.outcome] || answer.outcome;
      this.slider.max = String(this.episode.end);
      this.#shown(true);
      this.seek(0);
      this.toggle(!matchMedia("(prefers-reduced-motion: reduce)").matches);
    } catch (error) {
      this.said.textContent = "";
      throw error;
    } finally {
      this.start.disabled = false;
    }
  }

  /** @param {boolean} shown */
  #shown(shown) {
    for (const element of [this.pause, this.slider, this.end]) element.hidden = !shown;
  }

  /** @param {number} time s */
  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.episode?.end ?? 0);
    this.slider.value = String(this.time);
    this.slider.title = `${this.time.toFixed(1)} s`;
    this.changed();
  }

  /** @param {boolean} [on] */
  toggle(on = !this.playing) {
    this.playing = on && this.episode !== null;
    this.pause.textContent = this.playing ? "Stop" : "Play";
    if (!this.playing) return;
    if (this.time >= (this.episode?.end ?? 0)) this.seek(0);
    this.last = performance.now();
    requestAnimationFrame((now) => this.#step(now));
  }

  /** @param {number} now ms */
  #step(now) {
    if (!this.playing) return;
    this.seek(this.time + (now - this.last) / 1000);
    this.last = now;
    if (this.time >= (this.episode?.end ?? 0)) this.toggle(false);
    else requestAnimationFrame((then) => this.#step(then));
  }

  stop() {
    this.toggle(false);
    this.episode = null;
    this.said.textContent = "";
    this.#shown(false);
    this.changed();
  }

  /** @param {CanvasRenderingContext2D} context @param {number} pixel @param {import("./looks.js").Colours} colours */
  draw(context, pixel, colours) {
    if (!this.episode || this.scene !== this.editor.at) return;
    const moment = this.episode.at(this.time);
    const { values, rows } = this.episode.arrays.pose;
    context.beginPath();
    for (let row = 0; row <= moment.row; row++) context.lineTo(values[row], values[rows + row]);
    context.lineTo(moment.pose[0], moment.pose[1]);
    context.strokeStyle = ROBOT;
    context.lineWidth = 2 * pixel;
    context.stroke();
    for (const { x, y, radius } of moment.people) {
      context.beginPath();
      context.arc(x, y, radius, 0, 2 * Math.PI);
      context.fillStyle = faded(colours.person, 0.95);
      context.fill();
      context.strokeStyle = colours.ink;
      context.lineWidth = 1.5 * pixel;
      context.stroke();
    }
    drawRobot(context, moment.pose, { footprint: this.episode.said.robot.footprint }, pixel, moment.touching ? colours.bad : ROBOT);
  }
}
