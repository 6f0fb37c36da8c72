// People on two legs, as lidars at the height of their shins see them: where the legs are follows from the way that is
// covered.
// The same sums as the simulators' (arena_kernels/legs.py), from one control step of the record to the next.

/**
 * @typedef {object} Gait lengths in m, speeds in m/s
 * @property {number} leg_radius
 * @property {number} stance_width
 * @property {number} step_width
 * @property {number} step_width_from
 * @property {number} walk_ratio @property {number} apart @property {number} settling
 */

const STANDING = 1e-4; // m/s; who stands keeps so much of the last velocity

/** How long a step is at a pace, m. @param {Gait} gait @param {number} pace */
export function stepLength(gait, pace) {
  return Math.sqrt(60 * gait.walk_ratio * Math.max(pace, STANDING));
}

/**
 * The velocity that legs have taken up after dt s; it never vanishes.
 * @param {Gait} gait
 * @param {number[]} velocity
 * @param {number[]} wanted
 * @param {number} dt
 */
export function settle(gait, velocity, wanted, dt) {
  const share = 1 - Math.exp(-dt / gait.settling);
  const next = [velocity[0] + share * (wanted[0] - velocity[0]), velocity[1] + share * (wanted[1] - velocity[1])];
  if (Math.hypot(next[0], next[1]) >= STANDING) return next;
  const pace = Math.hypot(velocity[0], velocity[1]);
  return [(velocity[0] * STANDING) / pace, (velocity[1] * STANDING) / pace];
}

/** Where the left leg is, from 1 in front to -1 behind, after so many steps. @param {number} steps */
const wave = (steps) => Math.abs(2 * (steps - 2 * Math.floor(steps / 2)) - 2) - 1;

/**
 * The left and the right leg's centre and their radius, all within the body's disc.
 * @param {Gait} gait
 * @param {number} x
 * @param {number} y
 * @param {number} radius
 * @param {number[]} velocity
 * @param {number} steps
 * @returns {number[]} x, y, x, y, radius
 */
export function legsOf(gait, x, y, radius, velocity, steps) {
  const pace = Math.hypot(velocity[0], velocity[1]);
  const [c, s] = [velocity[0] / pace, velocity[1] / pace];
  const leg = Math.min(gait.leg_radius, radius / 2);
  const narrow = Math.min(pace / gait.step_width_from, 1);
  const side = Math.min((gait.stance_width + narrow * (gait.step_width - gait.stance_width)) / 2, radius - leg);
  const room = Math.sqrt((radius - leg) ** 2 - side * side);
  const ahead = wave(steps) * Math.min((gait.apart * stepLength(gait, pace)) / 2, room);
  const [dx, dy] = [ahead * c - side * s, ahead * s + side * c];
  return [x + dx, y + dy, x - dx, y - dy, leg];
}

/**
 * Where one person's legs are at every row: five figures each, NaN while the person is not there; null where the person
 * has no legs.
 * @param {Gait} gait
 * @param {Float32Array | any} stamps
 * @param {(row: number) => number[]} place
 * @param {number} radius
 * @param {number[]} begin steps, direction
 * @returns {Float32Array | null}
 */
export function walk(gait, stamps, place, radius, begin) {
  if (Number.isNaN(begin[0])) return null;
  const found = new Float32Array(5 * stamps.length).fill(NaN);
  let velocity = [STANDING * Math.cos(begin[1]), STANDING * Math.sin(begin[1])];
  let steps = begin[0];
  let before = [NaN, NaN];
  for (let row = 0; row < stamps.length; row++) {
    const here = place(row);
    const [dx, dy] = [here[0] - before[0], here[1] - before[1]];
    const dt = row ? stamps[row] - stamps[row - 1] : 0;
    if (!Number.isNaN(dx) && dt > 0) {
      velocity = settle(gait, velocity, [dx / dt, dy / dt], dt);
      steps += Math.hypot(dx, dy) / stepLength(gait, Math.hypot(velocity[0], velocity[1]));
    }
    if (!Number.isNaN(here[0])) found.set(legsOf(gait, here[0], here[1], radius, velocity, steps), 5 * row);
    before = here;
  }
  return found;
}
