// The experiments that were started: how far they are, what became of their last episodes, and what can be done with
// them.

import { button, make } from "studio/shell/forms.js";
import { duration } from "studio/run/wanted.js";

/** @typedef {import("studio/run/live.js").Experiment} Experiment */

const NAMES = /** @type {Record<string, string>} */ ({ refused: "did not begin", "cut off": "cut off" });

/** @param {string} run @param {number | string} episode */
export const replayAddress = (run, episode) => `/replay/?${new URLSearchParams({ run, episode: String(episode) })}`;

export class Experiments {
  /** @param {HTMLElement} root @param {(name: string, act: "stop" | "resume" | "forget") => void} act */
  constructor(root, act) {
    this.root = root;
    this.act = act;
    /** @type {Map<string, {card: HTMLElement, before: string}>} */ this.cards = new Map();
    this.none = make("p", { className: "soft" }, "Nothing was started here yet.");
  }

  /**
   * Show them; a card whose experiment stands as before is left alone, with what is opened or focused in it.
   * @param {Experiment[]} experiments
   */
  show(experiments) {
    const cards = experiments.map((one) => this.cardOf(one));
    const names = new Set(experiments.map(({ name }) => name));
    for (const name of this.cards.keys()) if (!names.has(name)) this.cards.delete(name);
    const wanted = cards.length ? cards : [this.none];
    if (wanted.length !== this.root.children.length || wanted.some((card, index) => this.root.children[index] !== card))
      this.root.replaceChildren(...wanted);
  }

  /** @param {Experiment} one */
  cardOf(one) {
    const now = JSON.stringify(one);
    const known = this.cards.get(one.name);
    const card =
      known?.card ??
      make("article", {
        className: "panel experiment",
        "data-name": one.name,
        "aria-label": `experiment ${one.folder}`,
      });
    if (known?.before !== now) this.fill(card, one);
    this.cards.set(one.name, { card, before: now });
    return card;
  }

  /** @param {HTMLElement} card @param {Experiment} one */
  fill(card, one) {
    const focused = card.contains(document.activeElement)
      ? /** @type {HTMLElement} */ (document.activeElement).dataset.act
      : undefined;
    const opened = new Map(
      [...card.querySelectorAll("details")].map((details) => [details.dataset.part, details.open]),
    );
    card.dataset.state = one.state;
    card.replaceChildren(this.head(one), bar(one), facts(one), ...(one.last.length ? [rows(one)] : []), ...said(one));
    for (const details of card.querySelectorAll("details"))
      details.open = opened.get(details.dataset.part) ?? details.open;
    if (focused) /** @type {HTMLElement | null} */ (card.querySelector(`[data-act="${focused}"]`))?.focus();
  }

  /** @param {Experiment} one */
  head(one) {
    const running = one.state === "running" || one.state === "stopping";
    const watch = make("a", { href: `/watch/${one.name}/`, target: "_blank", rel: "noopener" }, "watch");
    const results = make("a", { href: `#/results?${new URLSearchParams({ text: one.folder })}` }, "results");
    const acts = /** @type {["stop" | "resume" | "forget", string, boolean][]} */ ([
      ["stop", one.state === "stopping" ? "stop at once" : "stop", running],
      ["resume", "resume", one.state === "cut off"],
      ["forget", "take off the list", !running],
    ]);
    const buttons = acts
      .filter(([, , offered]) => offered)
      .map(([act, text]) => button(text, () => this.act(one.name, act), { "data-act": act }));
    const state = make("span", { className: `state ${one.state.replace(" ", "-")}` }, NAMES[one.state] ?? one.state);
    return make(
      "div",
      { className: "row" },
      state,
      make("h3", { className: "grow" }, one.folder),
      ...(running ? [watch] : []),
      ...(one.done ? [results] : []),
      ...buttons,
    );
  }
}

/** @param {Experiment} one */
function bar(one) {
  const share = `${one.done} of ${one.episodes} episodes`;
  return make("progress", { max: Math.max(1, one.episodes), value: one.done, "aria-label": share }, share);
}

/** @param {Experiment} one */
function facts(one) {
  const words = [`${one.done} of ${one.episodes} episodes`];
  if (one.jobs > 1) words.push(`${one.jobs} jobs`);
  if (one.workers) words.push(`${one.workers} worker${one.workers > 1 ? "s" : ""}`);
  if (one.left !== null) words.push(`about ${duration(one.left)} left`);
  else if (one.state === "running")
    words.push(one.done ? "time left not known yet" : "components are built and compiled first");
  return make("p", { className: "soft" }, words.filter(Boolean).join(" · "));
}

/** @param {Experiment} one */
function rows(one) {
  const head = ["replay", "episode", "planner", "robot", "world", "outcome", "time to goal [s]"].map((text) =>
    make("th", { scope: "col" }, text),
  );
  const lines = one.last.map((row) => {
    const link = make(
      "a",
      { href: replayAddress(one.folders[row.job], row.episode), target: "_blank", rel: "noopener" },
      "replay",
    );
    const time =
      row.time_to_goal && Number.isFinite(Number(row.time_to_goal)) ? Number(row.time_to_goal).toFixed(1) : "";
    const outcome = make("td", { title: row.error ?? "" }, (row.outcome ?? "").replaceAll("_", " "));
    const cells = [row.episode, row.preset, row.robot, row.world].map((text) => make("td", {}, text ?? ""));
    return make("tr", {}, make("td", {}, link), ...cells, outcome, make("td", { className: "number" }, time));
  });
  const table = make("table", {}, make("thead", {}, make("tr", {}, ...head)), make("tbody", {}, ...lines));
  return make(
    "details",
    { open: true, "data-part": "rows" },
    make("summary", {}, "last episodes"),
    make("div", { className: "scroll", tabIndex: 0, role: "region", "aria-label": "last episodes" }, table),
  );
}

/** @param {Experiment} one */
function said(one) {
  const wrong = one.state === "refused" || one.state === "cut off";
  const last = one.said.at(-1) ?? "";
  const line = wrong && last ? [make("p", { className: one.state === "refused" ? "bad" : "warn" }, last)] : [];
  const log = make("pre", { className: "code log", tabIndex: 0 }, one.said.join("\n"));
  const details = make(
    "details",
    { "data-part": "said" },
    make("summary", {}, "command and what it printed"),
    make("p", { className: "code" }, one.command),
    log,
  );
  return [...line, details];
}
