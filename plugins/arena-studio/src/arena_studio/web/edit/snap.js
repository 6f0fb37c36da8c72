// Where a point goes that is drawn by hand: onto a grid, onto a point nearby, along an eighth of a turn.

/** @typedef {[number, number]} Point  m */

/**
 * The nearest crossing of a grid of `step` m; 0: where it is.
 * @param {Point} point
 * @param {number} step
 * @param {Point} [from] a crossing
 * @returns {Point}
 */
export function toGrid([x, y], step, [ox, oy] = [0, 0]) {
  if (!(step > 0)) return [x, y];
  return [ox + step * Math.round((x - ox) / step), oy + step * Math.round((y - oy) / step)];
}

/**
 * The nearest of the points within `reach` m, else null.
 * @param {Point} point
 * @param {Point[]} points
 * @param {number} reach
 * @returns {Point | null}
 */
export function toPoint([x, y], points, reach) {
  /** @type {Point | null} */ let best = null;
  let least = reach;
  for (const point of points) {
    const far = Math.hypot(point[0] - x, point[1] - y);
    if (far <= least) [best, least] = [point, far];
  }
  return best;
}

/**
 * The end of a line from a point, turned to the nearest multiple of `angle` rad.
 * @param {Point} from
 * @param {Point} to
 * @param {number} [angle]
 * @returns {Point}
 */
export function toAngle(from, to, angle = Math.PI / 4) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const turned = angle * Math.round(Math.atan2(dy, dx) / angle);
  const [ux, uy] = [Math.cos(turned), Math.sin(turned)];
  const length = dx * ux + dy * uy;
  return [from[0] + length * ux, from[1] + length * uy];
}

/** A step of a grid that is 1, 2 or 5 times a power of ten and at least `least` m. @param {number} least */
export function roundStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return ([1, 2, 5].find((factor) => factor * power >= least * (1 - 1e-9)) ?? 10) * power;
}
