// Beams cast again, without noise, for records that kept no scans: cells of the map one after the other, discs of
// people, obstacles, closed doors and teammates.

import { bodiesOf } from "arena/people.js";

/**
 * Return where a map's cell is occupied, unknown or free: 1, 2, 0; beyond the map free.
 * @param {any} map @param {number} i column @param {number} j row
 */
export function cell(map, i, j) {
  const [height, width] = map.cells.shape;
  return i < 0 || j < 0 || i >= width || j >= height ? 0 : map.cells.values[j * width + i];
}

/**
 * Return the ranges of all beams, m; Infinity where nothing is in range.
 * @param {any} map
 * @param {number[]} pose of the robot
 * @param {any} lidar
 * @param {{x: number, y: number, radius: number}[]} discs
 * @param {number[][]} [sides] of polygons: x, y of both ends
 * @returns {Float32Array}
 */
export function cast(map, pose, lidar, discs, sides = []) {
  const [c, s] = [Math.cos(pose[2]), Math.sin(pose[2])];
  const x = pose[0] + c * lidar.mount.x - s * lidar.mount.y;
  const y = pose[1] + s * lidar.mount.x + c * lidar.mount.y;
  const first = pose[2] + lidar.mount.theta + lidar.angle_min;
  const near = discs.filter((body) => Math.hypot(body.x - x, body.y - y) < lidar.range_max + body.radius);
  const ranges = new Float32Array(lidar.beams);
  for (let beam = 0; beam < lidar.beams; beam++) {
    const angle = first + beam * lidar.angle_increment;
    const [dx, dy] = [Math.cos(angle), Math.sin(angle)];
    let reach = map ? walls(map, x, y, dx, dy, lidar.range_max) : Infinity;
    for (const body of near) reach = Math.min(reach, disc(body, x, y, dx, dy));
    for (const side of sides) reach = Math.min(reach, wall(side, x, y, dx, dy));
    ranges[beam] = reach <= lidar.range_max ? reach : Infinity;
  }
  return ranges;
}

/**
 * The distance to a disc along a ray, Infinity where it is missed.
 * @param {{x: number, y: number, radius: number}} body
 */
function disc(
  body,
  /** @type {number} */ x,
  /** @type {number} */ y,
  /** @type {number} */ dx,
  /** @type {number} */ dy,
) {
  const [ox, oy] = [body.x - x, body.y - y];
  const along = ox * dx + oy * dy;
  const root = along * along - (ox * ox + oy * oy - body.radius * body.radius);
  if (along <= 0 || root < 0) return Infinity;
  return Math.max(0, along - Math.sqrt(root));
}

/** The distance to a polygon's side along a ray, Infinity where it is missed. @param {number[]} side */
function wall(
  [ax, ay, bx, by],
  /** @type {number} */ x,
  /** @type {number} */ y,
  /** @type {number} */ dx,
  /** @type {number} */ dy,
) {
  const [ex, ey] = [bx - ax, by - ay];
  const across = dx * ey - dy * ex;
  if (!across) return Infinity;
  const along = ((ax - x) * ey - (ay - y) * ex) / across;
  const share = ((ax - x) * dy - (ay - y) * dx) / across;
  return along >= 0 && share >= 0 && share <= 1 ? along : Infinity;
}

/**
 * Return what a robot's beams meet at a moment: those that were kept, else they are cast again.
 * @param {import("./episode.js").Episode} episode @param {import("./episode.js").Moment} moment
 * @returns {ArrayLike<number>}
 */
export function rangesOf(episode, moment) {
  const kept = episode.scan(moment.row);
  if (kept) return kept;
  const { robot, obstacles, doors = [] } = episode.said;
  const discs = [...bodiesOf(moment.people)];
  const closed = doors.filter(
    (/** @type {any} */ _, /** @type {number} */ door) => !episode.doorOpen(door, moment.time),
  );
  const sides = [];
  for (const points of [...obstacles.map((/** @type {any} */ one) => one.vertices_xy), ...closed])
    for (let k = 0; points.length > 2 && k < points.length; k++)
      sides.push([...points[k], ...points[(k + 1) % points.length]]);
  const { vertices_xy: outline, radius: reach } = robot.footprint;
  for (const [x, y, theta] of moment.team) {
    if (!outline.length) discs.push({ x, y, radius: reach });
    const [c, s] = [Math.cos(theta), Math.sin(theta)];
    const points = outline.map((/** @type {number[]} */ [a, b]) => [x + c * a - s * b, y + s * a + c * b]);
    for (let k = 0; k < points.length; k++) sides.push([...points[k], ...points[(k + 1) % points.length]]);
  }
  for (const { vertices_xy: points, radius } of obstacles)
    if (points.length < 3) discs.push({ x: points[0][0], y: points[0][1], radius });
  return cast(episode.map, moment.pose, robot.lidar, discs, sides);
}

/** The distance to the first occupied cell along a ray (Amanatides and Woo 1987). */
function walls(
  /** @type {any} */ map,
  /** @type {number} */ x,
  /** @type {number} */ y,
  /** @type {number} */ dx,
  /** @type {number} */ dy,
  /** @type {number} */ most,
) {
  const [ox, oy, turn] = map.origin;
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  const size = map.resolution;
  const px = (c * (x - ox) + s * (y - oy)) / size;
  const py = (-s * (x - ox) + c * (y - oy)) / size;
  const ux = c * dx + s * dy;
  const uy = -s * dx + c * dy;
  let [i, j] = [Math.floor(px), Math.floor(py)];
  const [stepX, stepY] = [Math.sign(ux), Math.sign(uy)];
  const [perX, perY] = [Math.abs(1 / ux), Math.abs(1 / uy)];
  let nextX = ux > 0 ? (i + 1 - px) * perX : (px - i) * perX;
  let nextY = uy > 0 ? (j + 1 - py) * perY : (py - j) * perY;
  let gone = 0;
  while (gone * size <= most) {
    if (cell(map, i, j) === 1) return gone * size;
    if (nextX < nextY) {
      gone = nextX;
      nextX += perX;
      i += stepX;
    } else {
      gone = nextY;
      nextY += perY;
      j += stepY;
    }
  }
  return Infinity;
}
