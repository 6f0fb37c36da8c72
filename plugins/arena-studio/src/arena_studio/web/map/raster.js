// Shapes as runs of cells. A cell belongs to a shape when its centre lies in it; lengths are cells, columns to the
// right, rows down.

/** @typedef {[number, number]} Point */
/** @typedef {(row: number, left: number, right: number) => void} Fill  of the cells left <= column < right */

/**
 * The columns whose centres lie in [from, to).
 * @param {Fill} fill
 * @param {number} row
 * @param {number} from
 * @param {number} to
 */
function run(fill, row, from, to) {
  const [left, right] = [Math.ceil(from - 0.5), Math.ceil(to - 0.5)];
  if (right > left) fill(row, left, right);
}

/**
 * Every cell that a line passes, each with a side in common with the next: nothing slips through.
 * @param {Point} from
 * @param {Point} to
 * @param {Fill} fill
 */
export function line([x0, y0], [x1, y1], fill) {
  let [column, row] = [Math.floor(x0), Math.floor(y0)];
  const [lastColumn, lastRow] = [Math.floor(x1), Math.floor(y1)];
  const [dx, dy] = [x1 - x0, y1 - y0];
  const [stepX, stepY] = [Math.sign(dx), Math.sign(dy)];
  const next = (
    /** @type {number} */ at,
    /** @type {number} */ cell,
    /** @type {number} */ step,
    /** @type {number} */ way,
  ) => (step ? (cell + (step > 0 ? 1 : 0) - at) / way : Infinity);
  let [tx, ty] = [next(x0, column, stepX, dx), next(y0, row, stepY, dy)];
  const most = Math.abs(lastColumn - column) + Math.abs(lastRow - row);
  fill(row, column, column + 1);
  for (let i = 0; i < most; i++) {
    if (tx <= ty) {
      column += stepX;
      tx += stepX / dx;
    } else {
      row += stepY;
      ty += stepY / dy;
    }
    fill(row, column, column + 1);
  }
}

/**
 * All within `radius` of a line, as a round brush paints it; never less than the line itself.
 * @param {Point} from
 * @param {Point} to
 * @param {number} radius
 * @param {Fill} fill
 */
export function stroke(from, to, radius, fill) {
  line(from, to, fill);
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const side = length ? [(-(to[1] - from[1]) / length) * radius, ((to[0] - from[0]) / length) * radius] : [0, 0];
  /** @type {Point[]} */
  const band = [
    [from[0] + side[0], from[1] + side[1]],
    [to[0] + side[0], to[1] + side[1]],
    [to[0] - side[0], to[1] - side[1]],
    [from[0] - side[0], from[1] - side[1]],
  ];
  const [top, bottom] = [Math.min(from[1], to[1]) - radius, Math.max(from[1], to[1]) + radius];
  for (let row = Math.floor(top); row <= bottom; row++) {
    const y = row + 0.5;
    const edges = [...disc(from, radius, y), ...disc(to, radius, y), ...crossings(band, y)];
    if (edges.length) run(fill, row, Math.min(...edges), Math.max(...edges)); // the shape is convex: one run
  }
}

/**
 * A straight wall `width` thick. Along the cells its ends are square, so that corners close; else they are round.
 * @param {Point} from
 * @param {Point} to
 * @param {number} width
 * @param {Fill} fill
 */
export function wall(from, to, width, fill) {
  const [dx, dy] = [Math.abs(to[0] - from[0]), Math.abs(to[1] - from[1])];
  if (width <= 1 || Math.min(dx, dy) > 1e-6 * Math.max(dx, dy, 1)) {
    stroke(from, to, width / 2, fill);
    return;
  }
  const half = width / 2;
  rectangle(
    [Math.min(from[0], to[0]) - half, Math.min(from[1], to[1]) - half],
    [Math.max(from[0], to[0]) + half, Math.max(from[1], to[1]) + half],
    fill,
  );
}

/**
 * A rectangle along the cells, at least one cell.
 * @param {Point} one
 * @param {Point} other opposite corners
 * @param {Fill} fill
 */
export function rectangle(one, other, fill) {
  const [left, right] = ends(one[0], other[0]);
  const [top, bottom] = ends(one[1], other[1]);
  for (let row = top; row < bottom; row++) fill(row, left, right);
}

/** @param {number} a @param {number} b */
function ends(a, b) {
  const [low, high] = [Math.round(Math.min(a, b)), Math.round(Math.max(a, b))];
  return high > low ? [low, high] : [Math.floor(Math.min(a, b)), Math.floor(Math.min(a, b)) + 1];
}

/** The walls around some corners. @param {Point[]} corners @param {number} width @param {Fill} fill */
export function outline(corners, width, fill) {
  corners.forEach((corner, i) => wall(corner, corners[(i + 1) % corners.length], width, fill));
}

/** A polygon's inside, even-odd where it crosses itself. @param {Point[]} corners @param {Fill} fill */
export function polygon(corners, fill) {
  const ys = corners.map((corner) => corner[1]);
  for (let row = Math.floor(Math.min(...ys)); row <= Math.max(...ys); row++) {
    const at = crossings(corners, row + 0.5).sort((a, b) => a - b);
    for (let i = 0; i + 1 < at.length; i += 2) run(fill, row, at[i], at[i + 1]);
  }
}

/** Where a level line crosses a polygon's sides. @param {Point[]} corners @param {number} y @returns {number[]} */
function crossings(corners, y) {
  const found = [];
  for (let i = 0; i < corners.length; i++) {
    const [[x0, y0], [x1, y1]] = [corners[i], corners[(i + 1) % corners.length]];
    if (y0 <= y !== y1 <= y) found.push(x0 + ((y - y0) / (y1 - y0)) * (x1 - x0));
  }
  return found;
}

/** Where a level line crosses a circle. @param {Point} centre @param {number} radius @param {number} y */
function disc([cx, cy], radius, y) {
  const half = radius * radius - (y - cy) * (y - cy);
  return half > 0 ? [cx - Math.sqrt(half), cx + Math.sqrt(half)] : [];
}

/**
 * The cells that hang together, over their sides, with one of the same kind; `kinds` says which kind a code is of.
 * @param {{width: number, height: number, cells: Uint8Array}} grid
 * @param {Uint8Array} kinds
 * @param {number} column
 * @param {number} row
 * @param {Fill} fill
 */
export function flood({ width, height, cells }, kinds, column, row, fill) {
  if (column < 0 || row < 0 || column >= width || row >= height) return;
  const kind = kinds[cells[row * width + column]];
  const open = new Uint8Array(cells.length); // of the kind, and not filled yet
  for (let at = 0; at < cells.length; at++) if (kinds[cells[at]] === kind) open[at] = 1;
  const seeds = [row * width + column];
  const seek = (/** @type {number} */ from, /** @type {number} */ to) => {
    for (let at = from, before = 0; at < to; at++) {
      if (open[at] > before) seeds.push(at);
      before = open[at];
    }
  };
  while (seeds.length) {
    const at = /** @type {number} */ (seeds.pop());
    if (!open[at]) continue;
    const first = at - (at % width);
    let [left, right] = [at, at + 1];
    while (left > first && open[left - 1]) left -= 1;
    while (right < first + width && open[right]) right += 1;
    open.fill(0, left, right);
    fill(first / width, left - first, right - first);
    if (first > 0) seek(left - width, right - width);
    if (first + width < open.length) seek(left + width, right + width);
  }
}
