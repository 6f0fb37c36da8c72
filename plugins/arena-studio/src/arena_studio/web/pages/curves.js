// Tunings, ladders and trainings of the folder, running or finished: their curves, and what came of them.

import { make, settled } from "studio/shell/forms.js";
import { ladderPieces, titleOf as titleOfLadder } from "studio/curves/ladder.js";
import { layOut } from "studio/curves/pieces.js";
import { ago } from "studio/curves/scale.js";
import { titleOf as titleOfTraining, trainingPieces } from "studio/curves/training.js";
import { titleOf as titleOfTuning, tuningPieces } from "studio/curves/tuning.js";

const EVERY = 2500; // ms between two looks at what was written meanwhile
const KINDS = /** @type {Record<string, import("studio/curves/pieces.js").Kind>} */ ({
  tuning: { title: titleOfTuning, pieces: tuningPieces },
  ladder: { title: titleOfLadder, pieces: ladderPieces },
  training: { title: titleOfTraining, pieces: trainingPieces },
});

/**
 * @typedef {object} Study
 * @property {string} path
 * @property {"tuning" | "ladder" | "training"} kind
 * @property {"running" | "finished" | "stopped"} state
 * @property {number} quiet s
 */

class CurvesPage {
  /** @param {HTMLElement} root @param {import("studio/shell/pages.js").Context} context */
  constructor(root, context) {
    this.root = root;
    this.context = context;
    this.path = context.query.get("path") ?? "";
    this.before = "";
    this.listed = "";
    this.turn = 0;
    /** @type {(Study & {found: any}) | null} */ this.shown = null;
    this.list = make("nav", { className: "studies", "aria-label": "tunings, ladders and trainings" });
    this.head = make("div", { className: "head" });
    this.wrong = make("p", { className: "bad", role: "alert", hidden: true });
    this.body = make("div", { className: "pieces" });
  }

  lay() {
    const right = make("section", { className: "shown", "aria-label": "curves" }, this.head, this.wrong, this.body);
    this.root.append(make("h1", {}, "Curves"), make("div", { className: "two-parts" }, this.list, right));
  }

  /** Look at the list and at what is shown; what comes late is dropped. */
  async look() {
    const turn = ++this.turn;
    try {
      const { folders } = await this.context.api.get("/api/curves");
      if (turn !== this.turn) return;
      this.fill(folders);
      this.path ||= folders[0]?.path ?? "";
      if (!this.path) return this.nothing();
      const found = await this.context.api.get(`/api/curves/folder?${new URLSearchParams({ path: this.path })}`);
      if (turn !== this.turn) return;
      this.take(found);
    } catch (error) {
      if (turn === this.turn) this.tell(error instanceof Error ? error.message : String(error));
    }
  }

  nothing() {
    const text =
      "Nothing in this folder was tuned or trained yet, and no ladder driven: arena tune, arena train, arena ladder.";
    this.body.replaceChildren(make("p", { className: "soft empty" }, text));
  }

  /** What is wrong, above what was last seen. @param {string} text */
  tell(text) {
    this.wrong.textContent = text;
    this.wrong.hidden = !text;
  }

  /** @param {Study[]} folders */
  fill(folders) {
    const now = JSON.stringify([folders.map(({ path, kind, state }) => [path, kind, state]), this.path]);
    if (now === this.listed) return;
    this.listed = now;
    const focused = /** @type {HTMLElement | null} */ (document.activeElement)?.dataset.path;
    this.list.replaceChildren(...folders.map((one, place) => this.link(one, place)));
    if (focused !== undefined)
      /** @type {HTMLElement | null} */ (this.list.querySelector(`[data-path="${CSS.escape(focused)}"]`))?.focus();
  }

  /** @param {Study} one @param {number} place */
  link({ path, kind, state }, place) {
    const query = new URLSearchParams({ path });
    const shown = this.path ? path === this.path : place === 0;
    return make(
      "a",
      { href: `#/curves?${query}`, "data-path": path, ...(shown ? { "aria-current": "true" } : {}) },
      make("span", { className: "name" }, path === "." ? "this folder" : path),
      make("span", { className: "soft" }, `${kind}, `, make("span", { className: `is ${state}` }, state)),
    );
  }

  /** @param {Study & {found: any}} shown */
  take(shown) {
    this.tell("");
    this.shown = shown;
    const { kind, state, quiet, found, path } = shown;
    const state_ = make("span", { className: `state ${state === "stopped" ? "cut-off" : state}` }, state);
    const when = make("span", { className: "soft" }, `last written ${ago(quiet)}`);
    this.head.replaceChildren(
      make("h2", {}, `${KINDS[kind].title(found)} `),
      make("div", { className: "row" }, state_, when, make("code", {}, path)),
    );
    const now = JSON.stringify([path, found]);
    if (now !== this.before) this.draw();
    this.before = now;
  }

  /** Draw it again; what has the focus and what is unfolded stays so. */
  draw() {
    if (!this.shown) return;
    const active = /** @type {HTMLElement | SVGElement | null} */ (document.activeElement);
    const chart = active?.dataset.chart;
    const open = [...this.body.querySelectorAll("details")].map((details) => details.open);
    const { kind, found, path } = this.shown;
    this.body.replaceChildren(...layOut(KINDS[kind].pieces(found, path), this.body.clientWidth || 600));
    [...this.body.querySelectorAll("details")].forEach((details, place) => (details.open = open[place] ?? false));
    if (chart)
      /** @type {SVGElement | null} */ (this.body.querySelector(`[data-chart="${CSS.escape(chart)}"]`))?.focus();
  }
}

/** @type {import("studio/shell/pages.js").Page} */
export const page = {
  name: "curves",
  title: "Curves",
  async mount(root, context) {
    const style = make("link", { rel: "stylesheet", href: "/web/curves/curves.css" });
    const styled = new Promise((done) => style.addEventListener("load", done, { once: true }));
    document.head.append(style);
    await styled;
    const shown = new CurvesPage(root, context);
    shown.lay();
    await shown.look();
    const timer = setInterval(() => document.visibilityState === "visible" && shown.look(), EVERY);
    const again = settled(() => shown.draw(), 150);
    addEventListener("resize", again);
    return () => {
      clearInterval(timer);
      removeEventListener("resize", again);
      style.remove();
    };
  },
};
