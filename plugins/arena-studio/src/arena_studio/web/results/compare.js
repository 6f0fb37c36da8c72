// What the core's statistics say of the planners: differences to a baseline on the same scenarios, with intervals and p after Holm.

import { make } from "studio/shell/forms.js";
import { written } from "studio/results/table.js";

/**
 * @typedef {object} Compared
 * @property {string} planner
 * @property {string} baseline
 * @property {string} condition
 * @property {string} metric
 * @property {string} unit
 * @property {string} over
 * @property {number | null} difference
 * @property {number | null} low
 * @property {number | null} high
 * @property {number | null} p
 * @property {number | null} p_holm
 * @property {number} pairs
 * @property {number} problems
 */

const SURE = 0.05; // p after Holm up to which chance does not explain a difference
const FIRST = ["success", "strict_success", "time_to_goal", "path_length", "collisions", "collisions_caused", "clearance_min"];

/** @param {Compared[]} rows @param {boolean} all metrics, not the usual ones alone */
export function comparison(rows, all) {
  const known = rows.filter(({ pairs, metric }) => pairs > 0 && (all || FIRST.includes(metric)));
  if (!known.length) return make("p", { className: "soft" }, "There is nothing to compare: it takes two planners on the same scenarios, with the same robot.");
  const several = known.some(({ condition }) => condition);
  const names = ["difference", ...(several ? ["condition"] : []), "metric", "mean [95 % interval]", "p after Holm", "pairs", "over"];
  const lines = [...known].sort((a, b) => rank(a) - rank(b)).map((row) => line(row, several));
  return make("div", { className: "scroll", tabIndex: 0, role: "region", "aria-label": "comparison of planners" },
    make("table", {}, make("thead", {}, make("tr", {}, ...names.map((name) => make("th", { scope: "col" }, name)))), make("tbody", {}, ...lines)));
}

/** @param {Compared} row */
function rank({ metric }) {
  const place = FIRST.indexOf(metric);
  return place < 0 ? FIRST.length : place;
}

/** @param {Compared} row @param {boolean} several */
function line(row, several) {
  const sure = row.p_holm !== null && row.p_holm <= SURE;
  const interval = row.low === null ? "" : ` [${written(row.low)}, ${written(row.high)}]`;
  const unit = row.unit && row.unit !== "-" ? ` [${row.unit}]` : "";
  const cells = [
    make("td", {}, `${row.planner} − ${row.baseline}`),
    ...(several ? [make("td", {}, row.condition)] : []),
    make("td", {}, row.metric.replaceAll("_", " ") + unit),
    make("td", { className: "number" }, row.difference === null ? "" : `${written(row.difference)}${interval}`),
    make("td", { className: sure ? "number sure" : "number" }, row.p_holm === null ? "" : `${row.p_holm < 0.001 ? "< 0.001" : row.p_holm.toFixed(3)}${sure ? " *" : ""}`),
    make("td", { className: "number" }, String(row.pairs)),
    make("td", {}, row.over),
  ];
  return make("tr", {}, ...cells);
}
