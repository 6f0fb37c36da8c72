// A training: reward, success, entropy and what else it wrote, by steps.

import { make } from "studio/shell/forms.js";
import { short } from "studio/curves/scale.js";

/**
 * @typedef {{title: string, unit: string, more: boolean, lines: {name: string, points: [number, number][]}[]}} Panel
 * @typedef {object} Score
 * @property {number} success
 * @property {number} collision
 * @property {number} time_out
 * @property {number} episodes
 * @property {[number, number]} interval
 *
 * @typedef {object} Training
 * @property {string} planner
 * @property {string} robot
 * @property {number | null} seed
 * @property {number | null} total
 * @property {string} axis
 * @property {number} last
 * @property {Panel[]} panels
 * @property {number | null} choice
 * @property {Score | null} test
 */

/** @param {Training} found */
export const titleOf = ({ planner, robot, seed }) =>
  `${planner || "a network"}${robot ? ` on ${robot}` : ""}${seed === null ? "" : `, seed ${seed}`}`;

/** @param {Training} found @returns {import("studio/curves/pieces.js").Piece[]} */
export function trainingPieces(found) {
  const charts = found.panels.map((panel) => ({ chart: chartOf(panel, found), more: panel.more }));
  const none = "Nothing was drawn yet: the first point comes with the first validation or the first rollouts.";
  return [
    { element: standing(found) },
    ...(charts.length ? charts : [{ element: make("p", { className: "soft" }, none) }]),
  ];
}

/** @param {Training} found */
function standing({ axis, last, total, choice, test }) {
  const far = total ? `${short(last)} of ${short(total)} ${axis}` : `${short(last)} ${axis}`;
  const lines = [make("p", { className: "answer" }, far)];
  if (choice !== null)
    lines.push(make("p", {}, `The policy's weights are those after ${short(choice)} ${axis} (the dotted line).`));
  if (test)
    lines.push(
      make(
        "p",
        {},
        `Test: success ${test.success.toFixed(3)} (${test.interval.map((end) => end.toFixed(3)).join(" – ")}), ` +
          `collision ${test.collision.toFixed(3)}, time out ${test.time_out.toFixed(3)} of ${test.episodes} episodes.`,
      ),
    );
  return make("div", {}, ...lines);
}

/** @param {Panel} panel @param {Training} found @returns {import("studio/curves/chart.js").Chart} */
function chartOf({ title, unit, lines }, { axis, choice }) {
  const marks = choice === null ? [] : [{ x: choice, text: `weights after ${short(choice)} ${axis}` }];
  const shares = lines.every(({ points }) => points.every(([, y]) => y >= 0 && y <= 1)) && title === "Success";
  return { key: title, title, unit, along: axis, lines, marks, ...(shares ? { across: [0, 1] } : {}) };
}
