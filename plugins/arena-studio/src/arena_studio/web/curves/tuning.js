// A tuning: its races, the best so far, what each parameter matters, and present against best values.

import { button, make } from "studio/shell/forms.js";
import { short } from "studio/curves/scale.js";
import { svg } from "studio/curves/chart.js";

/**
 * @typedef {object} Set one set of values
 * @property {number} number
 * @property {number} race
 * @property {"whole" | "dropped" | "failed" | "racing"} ended
 * @property {number | null} advantage by the first objective
 * @property {number[]} [advantages] by each
 * @property {number} episodes
 *
 * @typedef {object} Parameter
 * @property {string} key
 * @property {any} present
 * @property {any} best
 * @property {number | null} importance
 * @property {string} [unit]
 * @property {string} [why]
 * @property {number} [low]
 * @property {number} [high]
 * @property {boolean} [log]
 *
 * @typedef {object} Tuning
 * @property {string} planner
 * @property {string} preset
 * @property {string} robot
 * @property {string} sampler
 * @property {number} seed
 * @property {string} objective
 * @property {string[]} [objectives]
 * @property {string} problems
 * @property {boolean} finished
 * @property {number} races
 * @property {Set[]} sets
 * @property {[number, number][]} curve
 * @property {{values: Record<string, any>, advantage: number | null, winner: boolean}} best
 * @property {Parameter[]} parameters
 * @property {{tune: number, validate: number, test: number}} episodes
 * @property {string | null} verdict
 * @property {{values: Record<string, any>, advantages: number[], chosen: boolean}[] | null} [pareto] of a finished one
 * @property {string | null} [rule] that chose one of these
 * @property {{figures?: Record<string, Record<string, number>>} | null} test
 */

const DASHBOARD = "http://127.0.0.1:8080/"; // where optuna-dashboard listens unless told otherwise

/** @param {Tuning} found */
export const titleOf = ({ preset, robot }) => `${preset} on ${robot}`;

/** @param {Tuning} found @param {string} path @returns {import("studio/curves/pieces.js").Piece[]} */
export function tuningPieces(found, path) {
  return [
    { element: standing(found) },
    { chart: bestChart(found) },
    { chart: setsChart(found) },
    ...((found.objectives ?? []).length > 1 ? [{ chart: paretoChart(found) }] : []),
    { element: values(found) },
    ...(found.pareto ? [{ element: pareto(found) }] : []),
    ...(found.test?.figures ? [{ element: test(found.test.figures) }] : []),
    { element: dashboard(path) },
  ];
}

/** @param {Tuning} found */
function standing(found) {
  const { sets, races, episodes, best } = found;
  const count = (/** @type {string} */ ended) => sets.filter((one) => one.ended === ended).length;
  const text =
    `${sets.length} sets of values in ${races} races: ${count("whole")} drove all problems, ` +
    `${count("dropped")} were dropped, ${count("failed")} failed. Episodes: ${episodes.tune} of the search, ` +
    `${episodes.validate} of validation, ${episodes.test} of the test.`;
  const advantage = best.advantage === null ? "" : short(best.advantage).replace(/^(?=\d)/, "+");
  const ahead =
    best.advantage === null
      ? "No set of values has driven all problems yet."
      : best.advantage > 0
        ? `Best so far: ${advantage} of the objective over the present values.`
        : `Best so far: ${advantage}; nothing is better than the present values yet.`;
  return make(
    "div",
    {},
    make("p", { className: "answer" }, found.verdict ?? ahead),
    make("p", {}, text),
    make(
      "p",
      { className: "hint" },
      `objective: ${found.objective}; problems ${found.problems}, sampler ${found.sampler}, seed ${found.seed}`,
    ),
  );
}

/** @param {Tuning} found @returns {import("studio/curves/chart.js").Chart} */
function bestChart(found) {
  const whole = found.sets.filter(({ ended, advantage }) => ended === "whole" && advantage !== null);
  return {
    key: "best",
    title: "Best so far",
    unit: "of the objective, over the present values",
    along: "episodes of the search",
    levels: [0],
    lines: [
      { name: "best", look: "step", points: found.curve },
      { name: "drove all problems", look: "points", points: pointsOf(whole, found.curve) },
    ],
  };
}

/** @param {Tuning} found @returns {import("studio/curves/chart.js").Chart} */
function setsChart(found) {
  const by = (/** @type {string} */ ended) =>
    /** @type {[number, number][]} */ (
      found.sets.filter((one) => one.ended === ended && one.advantage !== null).map((one) => [one.race, one.advantage])
    );
  return {
    key: "sets",
    title: "Races",
    unit: "what each set of values was worth when its race ended",
    along: "race",
    whole: true,
    levels: [0],
    lines: [
      { name: "dropped", look: "faint", points: by("dropped"), colour: 6 },
      { name: "drove all problems", look: "points", points: by("whole"), colour: 1 },
    ],
  };
}

/** What sets of values gained by the first two objectives. @param {Tuning} found
 * @returns {import("studio/curves/chart.js").Chart} */
function paretoChart({ sets, objectives = [] }) {
  const whole = sets.filter(({ ended, advantages }) => ended === "whole" && (advantages ?? []).length > 1);
  const points = whole.map(({ advantages = [] }) => /** @type {[number, number]} */ ([advantages[0], advantages[1]]));
  const beaten = (/** @type {[number, number]} */ [x, y]) =>
    points.some(([a, b]) => a >= x && b >= y && (a > x || b > y));
  const along = (/** @type {[number, number][]} */ some) => [...some].sort((a, b) => a[0] - b[0]);
  return {
    key: "pareto",
    title: "Two objectives",
    unit: `${objectives[1]}, over the present values`,
    along: `${objectives[0]}, over the present values`,
    levels: [0],
    marks: [{ x: 0, text: "present" }],
    lines: [
      { name: "beaten by another one in both", look: "faint", points: along(points.filter(beaten)), colour: 6 },
      { name: "beaten by none", look: "points", points: along(points.filter((one) => !beaten(one))), colour: 1 },
    ],
  };
}

/** The points of validation that no other one dominates. @param {Tuning} found */
function pareto({ pareto: points, objectives = [], rule }) {
  const heads = ["point", ...objectives];
  const told = (/** @type {Record<string, any>} */ own) =>
    Object.entries(own)
      .map((one) => one.join(" "))
      .join(", ");
  const rows = (points ?? []).map(({ advantages, chosen, values: own }, place) =>
    make(
      "tr",
      { title: told(own) },
      make("th", { scope: "row" }, chosen ? `${place + 1} (chosen)` : String(place + 1)),
      ...advantages.map((one) => make("td", { className: "number" }, text(one))),
    ),
  );
  return make(
    "section",
    { "aria-label": "pareto set" },
    make("h2", {}, "Pareto set, on validation"),
    make(
      "div",
      { className: "scroll", tabIndex: 0, role: "region", "aria-label": "points of the pareto set" },
      make("table", { className: "values" }, headOf(heads), make("tbody", {}, ...rows)),
    ),
    make("p", { className: "hint" }, `Gains over the present values. Chosen: ${rule}.`),
  );
}

/** @param {Set[]} sets @param {[number, number][]} curve @returns {[number, number][]} */
function pointsOf(sets, curve) {
  return /** @type {[number, number][]} */ (
    sets.map(({ race, advantage }) => [curve[Math.min(race, curve.length - 1)][0], advantage])
  );
}

/** @param {Tuning} found */
function values({ parameters, best }) {
  const known = parameters.some(({ importance }) => importance !== null);
  const most = Math.max(...parameters.map(({ importance }) => importance ?? 0), 1e-9);
  const rows = [...parameters].sort((a, b) => (b.importance ?? 0) - (a.importance ?? 0));
  const heads = ["parameter", "unit", "present", best.winner ? "winner" : "best so far", "range", "importance"];
  const note = known
    ? "Importance: the share of what differs between sets of values that a parameter explains (functional ANOVA)."
    : "Importance is noted once eight sets of values have driven all problems.";
  return make(
    "section",
    { "aria-label": "values" },
    make("h2", {}, "Present and best values"),
    make(
      "div",
      { className: "scroll", tabIndex: 0, role: "region", "aria-label": "present and best values" },
      make("table", { className: "values" }, headOf(heads), make("tbody", {}, ...rows.map((row) => line(row, most)))),
    ),
    make("p", { className: "hint" }, `Range: a ring is the present value, a dot the other one. ${note}`),
  );
}

const LEFT = new Set(["point", "parameter", "unit", "range", "importance", "on test"]); // heads above texts

/** @param {string[]} heads */
function headOf(heads) {
  const cells = heads.map((text) => make("th", { scope: "col", className: LEFT.has(text) ? "" : "number" }, text));
  return make("thead", {}, make("tr", {}, ...cells));
}

/** @param {Parameter} row @param {number} most */
function line(row, most) {
  const name = make("th", { scope: "row", title: row.why ?? "" }, row.key);
  const number = (/** @type {any} */ value) =>
    make("td", { className: "number" }, value === null || value === undefined ? "–" : text(value));
  const share = row.importance;
  const bar = make("td", { className: "share" });
  if (share !== null) {
    const width = 80 * (share / most);
    const drawn = svg("svg", { viewBox: "0 0 80 10", width: 80, height: 10, "aria-hidden": "true" });
    drawn.append(svg("rect", { x: 0, y: 1, width: Math.max(width, 1), height: 8, class: "fill" }));
    bar.append(/** @type {Node} */ (drawn), ` ${share.toFixed(2)}`);
  }
  return make(
    "tr",
    {},
    name,
    make("td", {}, row.unit ?? ""),
    number(row.present),
    number(row.best),
    make("td", {}, range(row)),
    bar,
  );
}

/** @param {any} value */
const text = (value) => (typeof value === "number" && Math.abs(value) < 1e4 ? short(value) : String(value));

/** Where the present value (hollow) and the best one (full) lie between the ends. @param {Parameter} row */
function range(row) {
  const { low = 0, high, log, present, best } = row;
  if (high === undefined || typeof present !== "number") return "";
  const scale = (/** @type {number} */ value) => (log ? Math.log(value) : value);
  const place = (/** @type {number} */ value) =>
    6 + 88 * Math.min(1, Math.max(0, (scale(value) - scale(low)) / (scale(high) - scale(low) || 1)));
  const label = `from ${text(low)} to ${text(high)}${log ? ", logarithmic" : ""}`;
  const drawn = svg("svg", { viewBox: "0 0 100 14", width: 100, height: 14, role: "img", "aria-label": label });
  drawn.append(svg("title", {}, label), svg("path", { d: "M6 7H94M6 4V10M94 4V10", class: "range" }));
  drawn.append(svg("circle", { cx: place(present), cy: 7, r: 4, class: "present" }));
  if (typeof best === "number") drawn.append(svg("circle", { cx: place(best), cy: 7, r: 3.5, class: "fill" }));
  return /** @type {Node} */ (drawn);
}

/** @param {Record<string, Record<string, number>>} figures */
function test(figures) {
  const heads = ["on test", "present", "winner", "difference", "95 % interval", "p"];
  const number = (/** @type {number | null} */ value) => (value === null ? "–" : text(value));
  const rows = Object.entries(figures).map(([name, one]) =>
    make(
      "tr",
      {},
      make("th", { scope: "row" }, name.replaceAll("_", " ")),
      ...[
        number(one.present),
        number(one.tuned),
        number(one.difference),
        `${number(one.low)} … ${number(one.high)}`,
        number(one.p),
      ].map((cell) => make("td", { className: "number" }, cell)),
    ),
  );
  return make(
    "section",
    { "aria-label": "test" },
    make("h2", {}, "Judged once, on the problems of the test"),
    make(
      "div",
      { className: "scroll", tabIndex: 0, role: "region", "aria-label": "figures on test" },
      make("table", { className: "values" }, headOf(heads), make("tbody", {}, ...rows)),
    ),
  );
}

/** @param {string} path */
function dashboard(path) {
  const place = path === "." ? "study.db" : `${path}/study.db`;
  const command = `optuna-dashboard 'sqlite:///${place}'`;
  const said = make("span", { className: "soft", role: "status" });
  const copy = button("copy", async () => {
    await navigator.clipboard.writeText(command);
    said.textContent = "copied";
  });
  const link = make("a", { href: DASHBOARD, target: "_blank", rel: "noopener" }, DASHBOARD);
  return make(
    "section",
    { "aria-label": "dashboard" },
    make("h2", {}, "In optuna-dashboard"),
    make("p", {}, "All sets of values one by one: start it in the project folder, then open ", link, "."),
    make("div", { className: "row" }, make("code", { className: "command" }, command), copy, said),
    make("p", { className: "hint" }, "It comes with pip install optuna-dashboard."),
  );
}
