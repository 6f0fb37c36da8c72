// What the core's statistics say of the planners: differences to a baseline on the same scenarios, with intervals and p
// after Holm.

import { make } from "studio/shell/forms.js";

/**
 * @typedef {object} Compared
 * @property {string} planner
 * @property {string} baseline
 * @property {string} condition
 * @property {string} metric
 * @property {string} title the words of the report for it and its unit
 * @property {string} shown the mean difference with its interval, in the report's words, with an asterisk where chance
 * does not explain it
 * @property {string} p_holm_shown
 * @property {string} over_shown
 * @property {number} pairs
 * @property {number} problems
 */

const FIRST = [
  "success",
  "strict_success",
  "time_to_goal",
  "path_length",
  "collisions",
  "collisions_caused",
  "clearance_min",
];

/** @param {Compared[]} rows @param {boolean} all metrics, not the usual ones alone */
export function comparison(rows, all) {
  const known = rows.filter(({ pairs, metric }) => pairs > 0 && (all || FIRST.includes(metric)));
  if (!known.length)
    return make(
      "p",
      { className: "soft" },
      "There is nothing to compare: it takes two planners on the same scenarios, with the same robot.",
    );
  const several = known.some(({ condition }) => condition);
  const names = [
    "difference",
    ...(several ? ["condition"] : []),
    "metric",
    "mean [95 % interval]",
    "p after Holm",
    "pairs",
    "pairs of",
  ];
  const lines = [...known].sort((a, b) => rank(a) - rank(b)).map((row) => line(row, several));
  return make(
    "div",
    { className: "scroll", tabIndex: 0, role: "region", "aria-label": "comparison of planners" },
    make(
      "table",
      {},
      make("thead", {}, make("tr", {}, ...names.map((name) => make("th", { scope: "col" }, name)))),
      make("tbody", {}, ...lines),
    ),
  );
}

/** @param {Compared} row */
function rank({ metric }) {
  const place = FIRST.indexOf(metric);
  return place < 0 ? FIRST.length : place;
}

/** @param {Compared} row @param {boolean} several */
function line(row, several) {
  const sure = row.shown.endsWith("*");
  const cells = [
    make("td", {}, `${row.planner} − ${row.baseline}`),
    ...(several ? [make("td", {}, row.condition)] : []),
    make("td", {}, row.title),
    make("td", { className: sure ? "number sure" : "number" }, row.shown),
    make("td", { className: "number" }, row.p_holm_shown),
    make("td", { className: "number" }, String(row.pairs)),
    make("td", {}, row.over_shown),
  ];
  return make("tr", {}, ...cells);
}
