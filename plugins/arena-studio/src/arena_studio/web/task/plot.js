// Small plots, one for each column of a curriculum, its levels from left to right.

import { COLUMNS, course, steps } from "studio/task/levels.js";

const [WIDTH, HEIGHT, LEFT, TOP, BOTTOM] = [240, 96, 34, 22, 16];
const SVG = "http://www.w3.org/2000/svg";

/** @param {string} tag @param {Record<string, string | number>} facts @param {string} [text] */
function svg(tag, facts, text = "") {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(facts)) element.setAttribute(name, String(value));
  element.textContent = text;
  return element;
}

/** @param {import("./levels.js").Level[]} levels @returns {SVGElement[]} */
export function plots(levels) {
  return COLUMNS.filter((column) => course(levels, column).known).map((column) => plot(levels, column));
}

/** @param {import("./levels.js").Level[]} levels @param {import("./levels.js").Column} column */
function plot(levels, column) {
  const { values, most } = course(levels, column);
  const title = `${column.title}${column.unit ? `, ${column.unit}` : ""}`;
  const root = /** @type {SVGElement} */ (
    svg("svg", {
      viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
      role: "img",
      "aria-label": `${title} by level: ${values.map((value) => value ?? "–").join(", ")}`,
    })
  );
  const [x, y] = [
    (/** @type {number} */ share) => LEFT + share * (WIDTH - LEFT - 8),
    (/** @type {number} */ share) => HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM),
  ];
  root.append(svg("text", { x: LEFT, y: 13, class: "title" }, title));
  for (const share of [0, 0.5, 1])
    root.append(svg("line", { x1: LEFT, x2: WIDTH - 8, y1: y(share), y2: y(share), class: "rule" }));
  root.append(
    svg("text", { x: LEFT - 4, y: y(1) + 4, class: "tick end" }, String(Math.round(100 * most) / 100)),
    svg("text", { x: LEFT - 4, y: y(0) + 4, class: "tick end" }, "0"),
  );
  for (const line of steps(values, most))
    root.append(svg("polyline", { points: line.map(([u, v]) => `${x(u)},${y(v)}`).join(" "), class: "course" }));
  root.append(
    svg("text", { x: x(0.5 / levels.length), y: HEIGHT - 4, class: "tick middle" }, "0"),
    svg(
      "text",
      { x: x(1 - 0.5 / levels.length), y: HEIGHT - 4, class: "tick middle" },
      levels.length > 1 ? String(levels.length - 1) : "",
    ),
  );
  return root;
}
