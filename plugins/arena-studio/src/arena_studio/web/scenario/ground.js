// The map under a scene: its cells, and what is free in it.

import { bytesOf, unpack } from "arena/decode.js";

/** @typedef {[number, number]} Point  m */
/**
 * @typedef {{resolution: number, origin: number[], width: number, height: number, cells: Uint8Array}} Ground  0 free, 1
 * occupied, 2 unknown; row 0 below
 */

/** @param {{resolution: number, origin: number[], shape: number[], cells: string}} said @returns {Promise<Ground>} */
export async function groundOf(said) {
  const cells = new Uint8Array(await unpack(bytesOf(said.cells)));
  return { resolution: said.resolution, origin: said.origin, width: said.shape[1], height: said.shape[0], cells };
}

/**
 * Column and row of the cell of a point, which may lie outside.
 * @param {Ground} ground
 * @param {Point} point
 * @returns {Point}
 */
export function cellAt({ resolution, origin }, [x, y]) {
  const [c, s] = [Math.cos(origin[2]), Math.sin(origin[2])];
  const [dx, dy] = [x - origin[0], y - origin[1]];
  return [Math.floor((c * dx + s * dy) / resolution), Math.floor((c * dy - s * dx) / resolution)];
}

/** @param {Ground} ground @param {number} column @param {number} row @returns {Point} */
export function centreOf({ resolution, origin }, column, row) {
  const [c, s] = [Math.cos(origin[2]), Math.sin(origin[2])];
  const [u, v] = [(column + 0.5) * resolution, (row + 0.5) * resolution];
  return [origin[0] + c * u - s * v, origin[1] + s * u + c * v];
}

/**
 * Whether all cells within a radius of a cell are free.
 * @param {Ground} ground
 * @param {number} column
 * @param {number} row
 * @param {number} radius m
 */
export function hasRoom({ resolution, width, height, cells }, column, row, radius) {
  const reach = Math.ceil(radius / resolution);
  for (let j = -reach; j <= reach; j++) {
    for (let i = -reach; i <= reach; i++) {
      if (Math.hypot(i, j) * resolution > radius) continue;
      const [u, v] = [column + i, row + j];
      if (u < 0 || v < 0 || u >= width || v >= height || cells[v * width + u] !== 0) return false;
    }
  }
  return true;
}

/**
 * The nearest point with so much room around it; the point itself where it has that, or where there is none within
 * `most` m.
 * @param {Ground} ground @param {Point} point @param {number} radius m @param {number} [most] @returns {Point}
 */
export function toFree(ground, point, radius, most = 2) {
  const [column, row] = cellAt(ground, point);
  if (hasRoom(ground, column, row, radius)) return point;
  let best = point;
  let least = Infinity;
  for (let ring = 1; ring * ground.resolution <= Math.min(most, least + ground.resolution); ring++) {
    for (const [i, j] of square(ring)) {
      const centre = centreOf(ground, column + i, row + j);
      const far = Math.hypot(centre[0] - point[0], centre[1] - point[1]);
      if (far < least && hasRoom(ground, column + i, row + j, radius)) [best, least] = [centre, far];
    }
  }
  return best;
}

/** The cells of a square's rim. @param {number} ring @returns {Generator<Point>} */
function* square(ring) {
  for (let k = -ring; k < ring; k++)
    yield* /** @type {Point[]} */ ([
      [k, -ring],
      [ring, k],
      [-k, ring],
      [-ring, -k],
    ]);
}

/** What of a map is known, with a margin: left, right, bottom, top, m. @param {Ground} ground */
export function windowOf(ground) {
  let [left, right, bottom, top] = [ground.width, 0, ground.height, 0];
  for (let row = 0; row < ground.height; row++) {
    for (let column = 0; column < ground.width; column++) {
      if (ground.cells[row * ground.width + column] === 2) continue;
      [left, right] = [Math.min(left, column), Math.max(right, column)];
      [bottom, top] = [Math.min(bottom, row), Math.max(top, row)];
    }
  }
  if (left > right) [left, right, bottom, top] = [0, ground.width - 1, 0, ground.height - 1];
  const corners = [left, right].flatMap((column) => [bottom, top].map((row) => centreOf(ground, column, row)));
  const [xs, ys] = [0, 1].map((axis) => corners.map((corner) => corner[axis]));
  return [Math.min(...xs) - 0.5, Math.max(...xs) + 0.5, Math.min(...ys) - 0.5, Math.max(...ys) + 0.5];
}
