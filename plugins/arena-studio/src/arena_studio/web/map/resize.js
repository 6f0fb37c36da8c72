// A map of another size: its cells, where its corner lies then, and what of it is known.

import { toMetres } from "studio/map/frame.js";

/** @typedef {import("./grid.js").Box} Box  of cells of the old map; what lies beyond it is new */
/** @typedef {{width: number, height: number, cells: Uint8Array}} Cells  row 0 at the top */

/**
 * The cells of a box; new ones get a code.
 * @param {Cells} old
 * @param {Box} box
 * @param {number} code
 * @returns {Cells}
 */
export function resized(old, box, code) {
  const [width, height] = [box.right - box.left, box.bottom - box.top];
  const cells = new Uint8Array(width * height).fill(code);
  const [left, right] = [Math.max(box.left, 0), Math.min(box.right, old.width)];
  if (right <= left) return { width, height, cells };
  for (let row = Math.max(box.top, 0); row < Math.min(box.bottom, old.height); row++) {
    cells.set(
      old.cells.subarray(row * old.width + left, row * old.width + right),
      (row - box.top) * width + left - box.left,
    );
  }
  return { width, height, cells };
}

/**
 * Where the lower left corner of a box lies: everything in it stays where it is.
 * @param {import("./frame.js").Frame} frame
 * @param {Box} box
 * @returns {[number, number, number]}
 */
export function originOf(frame, box) {
  const [x, y] = toMetres(frame, [box.left, box.bottom]).map((value) => Number(value.toFixed(9)));
  return [x, y, frame.origin[2]];
}

/**
 * The box around all cells that are not of a kind, null where there are none.
 * @param {Cells} map
 * @param {Uint8Array} kinds of the codes
 * @param {number} kind
 * @returns {Box | null}
 */
export function boxWithout({ width, height, cells }, kinds, kind) {
  /** @type {Box} */ const box = { left: width, top: height, right: 0, bottom: 0 };
  for (let row = 0, at = 0; row < height; row++) {
    for (let column = 0; column < width; column++, at++) {
      if (kinds[cells[at]] === kind) continue;
      if (column < box.left) box.left = column;
      if (column >= box.right) box.right = column + 1;
      if (row < box.top) box.top = row;
      box.bottom = row + 1;
    }
  }
  return box.right > box.left ? box : null;
}

/**
 * The cells from corner to corner, at least one.
 * @param {[number, number]} one column and row, with fractions
 * @param {[number, number]} other
 * @returns {Box}
 */
export function boxBetween(one, other) {
  const [left, right, top, bottom] = [
    Math.min(one[0], other[0]),
    Math.max(one[0], other[0]),
    Math.min(one[1], other[1]),
    Math.max(one[1], other[1]),
  ].map(Math.round);
  return { left, top, right: Math.max(right, left + 1), bottom: Math.max(bottom, top + 1) };
}
