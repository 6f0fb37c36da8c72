// Where something goes that is placed by hand: onto the grid, and to free ground.

import { toGrid } from "studio/edit/snap.js";
import { cellAt, hasRoom, toFree, windowOf } from "studio/scenario/ground.js";

/** @typedef {[number, number]} Point  m */

/**
 * The place of a hand: on the grid if it is wanted, then where there is room. Alt lets go of both.
 * @param {import("./editor.js").Editor} editor
 * @param {{point: Point, alt: boolean}} hand
 * @param {number} [room] m around it; 0: anywhere
 * @returns {Point}
 */
export function placed(editor, { point, alt }, room = 0) {
  if (alt) return point;
  const { snap, ground } = editor;
  const at = snap.grid ? toGrid(point, snap.step) : point;
  return snap.free && ground && room > 0 ? toFree(ground, at, room) : at;
}

/**
 * A place with as much room as there is near the middle of a map.
 * @param {import("./ground.js").Ground} ground
 * @returns {Point}
 */
export function middleOf(ground) {
  const [left, right, bottom, top] = windowOf(ground);
  const middle = /** @type {Point} */ ([(left + right) / 2, (bottom + top) / 2]);
  for (const room of [1, 0.5, 0.2]) {
    const found = toFree(ground, middle, room, Math.max(right - left, top - bottom));
    if (hasRoom(ground, ...cellAt(ground, found), room)) return found;
  }
  return middle;
}
