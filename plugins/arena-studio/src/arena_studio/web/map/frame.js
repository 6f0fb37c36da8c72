// Where cells lie in metres. Columns count from the left, rows from the top, as in the image; the map's origin is its
// lower left corner.

/** @typedef {[number, number]} Point */
/**
 * @typedef {{width: number, height: number, resolution: number, origin: number[]}} Frame  origin: x, y (m) and yaw
 * (rad)
 */

/**
 * The column and row, with fractions, under a point of the map, m.
 * @param {Frame} frame
 * @param {Point} point
 * @returns {Point}
 */
export function toCells({ height, resolution, origin }, [x, y]) {
  const [c, s] = [Math.cos(origin[2]), Math.sin(origin[2])];
  const [dx, dy] = [x - origin[0], y - origin[1]];
  return [(c * dx + s * dy) / resolution, height - (-s * dx + c * dy) / resolution];
}

/** The point of the map, m, at a column and row. @param {Frame} frame @param {Point} cell @returns {Point} */
export function toMetres({ height, resolution, origin }, [column, row]) {
  const [c, s] = [Math.cos(origin[2]), Math.sin(origin[2])];
  const [u, v] = [column * resolution, (height - row) * resolution];
  return [origin[0] + c * u - s * v, origin[1] + s * u + c * v];
}

/**
 * Snap a point to a grid of `step` m that begins in the map's corner and lies along its cells; 0: no grid.
 * @param {Frame} frame
 * @param {Point} point
 * @param {number} step
 * @returns {Point}
 */
export function snapped(frame, point, step) {
  if (!(step > 0)) return point;
  const [column, row] = toCells(frame, point);
  const cells = step / frame.resolution;
  return toMetres(frame, [
    cells * Math.round(column / cells),
    frame.height - cells * Math.round((frame.height - row) / cells),
  ]);
}

/** Left, right, bottom and top of a map, m. @param {Frame} frame */
export function windowOf(frame) {
  const corners = [0, frame.width].flatMap((column) => [0, frame.height].map((row) => toMetres(frame, [column, row])));
  const [xs, ys] = [0, 1].map((axis) => corners.map((corner) => corner[axis]));
  return [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
}

/** Have a context that draws in metres draw in cells. @param {CanvasRenderingContext2D} context @param {Frame} frame */
export function inCells(context, { height, resolution, origin }) {
  context.translate(origin[0], origin[1]);
  context.rotate(origin[2]);
  context.scale(resolution, -resolution);
  context.translate(0, -height);
}
