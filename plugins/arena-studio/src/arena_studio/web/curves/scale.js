// Axes without the DOM: round ticks, texts of numbers, and which point of lines is near.

/** @typedef {[number, number]} Point */

/**
 * Round numbers within an interval, about so many.
 * @param {number} low @param {number} high @param {number} count @returns {number[]}
 */
export function ticks(low, high, count) {
  if (!(high > low) || !Number.isFinite(high - low)) return [low];
  const raw = (high - low) / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5].find((one) => one * power >= raw * 0.999) ?? 10);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, place) => Number(((first + place) * step).toPrecision(12)));
}

/** A number as an axis shows it: 12 M, 250 k, 0.05. @param {number} value */
export function short(value) {
  const size = Math.abs(value);
  for (const [unit, name] of /** @type {[number, string][]} */ ([
    [1e9, " G"],
    [1e6, " M"],
    [1e4, " k"],
  ]))
    if (size >= unit) return `${Number((value / (name === " k" ? 1e3 : unit)).toPrecision(4))}${name}`;
  return String(size !== 0 && size < 1e-4 ? value.toExponential(1) : Number(value.toPrecision(4)));
}

/**
 * The interval that holds all values and those that must be seen, widened where it has no width.
 * @param {number[]} values @param {number[]} [seen] @returns {Point}
 */
export function extent(values, seen = []) {
  const all = [...values, ...seen].filter(Number.isFinite);
  if (!all.length) return [0, 1];
  const low = all.reduce((a, b) => Math.min(a, b));
  const high = all.reduce((a, b) => Math.max(a, b));
  if (high > low) return [low, high];
  const half = Math.abs(low) / 2 || 0.5;
  return [low - half, high + half];
}

/**
 * The last point of a line at or before x; the first where all are after it. Points are in order of x.
 * @param {Point[]} points @param {number} x
 */
export function pointAt(points, x) {
  let low = 0;
  let high = points.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (points[middle][0] <= x) low = middle + 1;
    else high = middle;
  }
  return points[Math.max(low - 1, 0)];
}

/** How long ago, in words. @param {number} seconds */
export function ago(seconds) {
  for (const [unit, name] of /** @type {[number, string][]} */ ([
    [86400, "day"],
    [3600, "hour"],
    [60, "minute"],
  ])) {
    const count = Math.floor(seconds / unit);
    if (count) return `${count} ${name}${count === 1 ? "" : "s"} ago`;
  }
  return "just now";
}
