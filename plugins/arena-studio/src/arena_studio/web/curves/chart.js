// A chart of lines and points as SVG. Arrows or the pointer read its values, which stand above it.

import { make } from "studio/shell/forms.js";
import { extent, pointAt, short, ticks } from "studio/curves/scale.js";

/** @typedef {import("studio/curves/scale.js").Point} Point */

/**
 * @typedef {object} Line
 * @property {string} name empty: not in the legend
 * @property {Point[]} points in order of x
 * @property {"line" | "step" | "dashed" | "points" | "faint"} [look]
 * @property {number} [colour] of the palette; its place among the lines where it is left out
 * @property {number[]} [sizes] radii of points
 *
 * @typedef {object} Bar a value with its interval along x
 * @property {number} x
 * @property {number} low
 * @property {number} high
 * @property {number} y
 * @property {number} colour
 *
 * @typedef {object} Chart
 * @property {string} key by which it is found again when it is drawn again
 * @property {string} title
 * @property {string} [unit] of y
 * @property {string} along what x is
 * @property {Line[]} lines
 * @property {number[]} [levels] values of y that have a rule of their own
 * @property {{x: number, text: string}[]} [marks] values of x that have one
 * @property {Bar[]} [bars]
 * @property {boolean} [whole] x is counted: no ticks between whole numbers
 * @property {Point} [across] what y shows; what the lines need where it is left out
 */

const SVG = "http://www.w3.org/2000/svg";
const [LEFT, RIGHT, TOP, BOTTOM] = [52, 14, 10, 40];
const COLOURS = 7;
/** Where each chart is read, by its key: it outlives a redraw. @type {Map<string, number>} */
const reading = new Map();

/** @param {string} tag @param {Record<string, string | number>} facts @param {string} [text] */
export function svg(tag, facts, text = "") {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(facts)) element.setAttribute(name, String(value));
  if (text) element.textContent = text;
  return element;
}

/** @param {Line} line @param {number} place */
const colourOf = (line, place) => (line.colour ?? place) % COLOURS;

/** @param {Chart} chart @param {number} width px */
export function figure(chart, width) {
  const height = Math.round(Math.min(300, Math.max(200, width * 0.5)));
  const drawn = draw(chart, width, height);
  const read = make("output", { className: "reading" });
  read.textContent = chart.lines.some((line) => line.points.length) ? " " : "nothing yet";
  const named = chart.lines.filter((line) => line.name);
  const legend = make("ul", { className: "legend" }, ...named.map((line) => key(line, chart.lines.indexOf(line))));
  addReading(chart, drawn, read, legend);
  const unit = chart.unit ? make("span", { className: "soft" }, ` ${chart.unit}`) : "";
  const head = make("figcaption", {}, make("b", {}, chart.title), unit);
  const element = make("figure", { className: "chart" }, head, read, drawn.root, legend);
  element.style.width = `${width}px`;
  return element;
}

/** @param {Line} line @param {number} place */
function key(line, place) {
  const sample = svg("svg", { viewBox: "0 0 26 10", class: "sample", "aria-hidden": "true" });
  const look = line.look ?? "line";
  const facts = { class: `${look} c${colourOf(line, place)}` };
  if (look === "points" || look === "faint") sample.append(svg("circle", { cx: 13, cy: 5, r: 3.5, ...facts }));
  else sample.append(svg("path", { d: "M1 5H25", ...facts }));
  return make(
    "li",
    {},
    /** @type {Node} */ (sample),
    line.name,
    make("b", { className: "value", "aria-hidden": "true" }),
  );
}

/** @param {Chart} chart @param {number} width @param {number} height */
function draw(chart, width, height) {
  const points = chart.lines.flatMap((line) => line.points);
  const bars = chart.bars ?? [];
  const xs = [...points.map(([x]) => x), ...bars.flatMap(({ low, high }) => [low, high])];
  const [left, right] = extent(xs);
  const [low, high] =
    chart.across ??
    extent(
      points.map(([, y]) => y),
      chart.levels,
    );
  const room = chart.across ? 0 : 0.05 * (high - low);
  const x = (/** @type {number} */ value) => LEFT + ((value - left) / (right - left)) * (width - LEFT - RIGHT);
  const y = (/** @type {number} */ value) =>
    height - BOTTOM - ((value - low + room) / (high - low + 2 * room)) * (height - TOP - BOTTOM);
  const root = /** @type {SVGSVGElement} */ (
    svg("svg", {
      viewBox: `0 0 ${width} ${height}`,
      width,
      height,
      role: "img",
      tabindex: 0,
      "aria-label": told(chart),
    })
  );
  root.dataset.chart = chart.key;
  for (const value of ticks(low, high, height / 55)) root.append(...rule(value, y(value), width));
  for (const value of ticks(left, right, width / 75).filter((one) => !chart.whole || Number.isInteger(one)))
    root.append(svg("text", { x: x(value), y: height - BOTTOM + 16, class: "tick middle" }, short(value)));
  root.append(svg("text", { x: (LEFT + width - RIGHT) / 2, y: height - 5, class: "tick middle along" }, chart.along));
  for (const level of chart.levels ?? [])
    root.append(svg("line", { x1: LEFT, x2: width - RIGHT, y1: y(level), y2: y(level), class: "level" }));
  for (const { x: at, text } of chart.marks ?? []) root.append(...mark(x(at), text, height));
  chart.lines.forEach((line, place) => root.append(...drawLine(line, colourOf(line, place), x, y)));
  for (const bar of bars) root.append(...drawBar(bar, x, y));
  return { root, x, y, width, height, left, right };
}

/** @param {number} value @param {number} y @param {number} width */
function rule(value, y, width) {
  const line = svg("line", { x1: LEFT, x2: width - RIGHT, y1: y, y2: y, class: "rule" });
  return [line, svg("text", { x: LEFT - 6, y: y + 4, class: "tick end" }, short(value))];
}

/** @param {number} x @param {string} text @param {number} height */
function mark(x, text, height) {
  const line = svg("line", { x1: x, x2: x, y1: TOP, y2: height - BOTTOM, class: "level" });
  line.append(svg("title", {}, text));
  return [line];
}

/**
 * @param {Line} line @param {number} colour
 * @param {(value: number) => number} x @param {(value: number) => number} y
 */
function drawLine(line, colour, x, y) {
  const look = line.look ?? "line";
  const facts = { class: `${look} c${colour}` };
  if (look === "points" || look === "faint")
    return line.points.map(([u, v], place) =>
      svg("circle", { cx: x(u), cy: y(v), r: line.sizes?.[place] ?? (look === "faint" ? 2.5 : 3.5), ...facts }),
    );
  const places = line.points.map(([u, v], place) => {
    const [px, py] = [x(u).toFixed(1), y(v).toFixed(1)];
    return place === 0 ? `M${px} ${py}` : look === "step" ? `H${px}V${py}` : `L${px} ${py}`;
  });
  return places.length ? [svg("path", { d: places.join(""), ...facts })] : [];
}

/** @param {Bar} bar @param {(value: number) => number} x @param {(value: number) => number} y */
function drawBar(bar, x, y) {
  const [from, to, at] = [x(bar.low), x(bar.high), y(bar.y)];
  const ends = `M${from} ${at}H${to}M${from} ${at - 4}V${at + 4}M${to} ${at - 4}V${at + 4}`;
  return [
    svg("path", { d: ends, class: `bar c${bar.colour % COLOURS}` }),
    svg("circle", { cx: x(bar.x), cy: at, r: 3, class: `points c${bar.colour % COLOURS}` }),
  ];
}

/** What a screen reader says of it: the first and last value of each line. @param {Chart} chart */
function told(chart) {
  const lines = chart.lines
    .filter(({ name, points }) => name && points.length)
    .map(({ name, points }) => {
      const [first, last] = [points[0], points[points.length - 1]];
      return `${name} ${short(first[1])} at ${short(first[0])}, ${short(last[1])} at ${short(last[0])}`;
    });
  return `${chart.title} over ${chart.along}: ${lines.join("; ") || "nothing yet"}. Arrows read values.`;
}

/**
 * Show the values at a place that arrows or the pointer choose: above the chart, and beside their names. Both have room
 * of their own, so that nothing moves.
 * @param {Chart} chart @param {ReturnType<typeof draw>} drawn @param {HTMLElement} read @param {HTMLElement} legend
 */
function addReading(chart, drawn, read, legend) {
  const { root, x, width, height, left, right } = drawn;
  const named = chart.lines.filter((line) => line.name);
  const lines = named.filter((line) => line.look !== "faint" && line.points.length);
  const cells = lines.map((line) => legend.children[named.indexOf(line)].querySelector(".value"));
  const stops = [...new Set(lines.flatMap((line) => line.points.map(([at]) => at)))].sort((a, b) => a - b);
  if (!stops.length) return;
  const cursor = svg("line", { y1: TOP, y2: height - BOTTOM, class: "cursor" });

  const show = (/** @type {number} */ at) => {
    reading.set(chart.key, at);
    cursor.setAttribute("x1", String(x(at)));
    cursor.setAttribute("x2", String(x(at)));
    root.append(cursor);
    const values = lines.map((line) => short(pointAt(line.points, at)[1]));
    read.textContent = `${short(at)}: ${lines.map(({ name }, place) => `${name} ${values[place]}`).join(", ")}`;
    cells.forEach((cell, place) => cell && (cell.textContent = values[place]));
  };
  const hide = () => {
    reading.delete(chart.key);
    cursor.remove();
    read.textContent = " ";
    for (const cell of cells) if (cell) cell.textContent = "";
  };
  root.addEventListener("pointermove", (event) => {
    const box = root.getBoundingClientRect();
    const share = (((event.clientX - box.left) * width) / box.width - LEFT) / (width - LEFT - RIGHT);
    show(pointAt(/** @type {Point[]} */ (stops.map((stop) => [stop, 0])), left + share * (right - left))[0]);
  });
  root.addEventListener("pointerleave", () => document.activeElement !== root && hide());
  root.addEventListener("blur", () => root.isConnected && hide());
  root.addEventListener("keydown", (event) => {
    const now = stops.indexOf(reading.get(chart.key) ?? NaN);
    const many = Math.max(1, Math.round(stops.length / 20));
    const next = /** @type {Record<string, number>} */ ({
      ArrowRight: now + (event.shiftKey ? many : 1),
      ArrowLeft: now < 0 ? stops.length - 1 : now - (event.shiftKey ? many : 1),
      Home: 0,
      End: stops.length - 1,
    })[event.key];
    if (event.key === "Escape") hide();
    if (next === undefined) return;
    event.preventDefault();
    show(stops[Math.min(Math.max(next, 0), stops.length - 1)]);
  });
  const before = reading.get(chart.key);
  if (before !== undefined && stops.includes(before)) show(before);
}
