// One recorded episode that can be asked for any moment; between two control steps everything moves evenly.

import { walk } from "arena/walk.js";

/**
 * @typedef {object} Moment
 * @property {number} time s
 * @property {number} row the control step that holds
 * @property {number[]} pose x, y, theta
 * @property {number[]} estimate
 * @property {number[]} twist vx, vy, wz
 * @property {{number: number, x: number, y: number, vx: number, vy: number, radius: number, state: number,
 * legs: number[] | null}[]}
 * people those who are in the world;
 * each may have ``legs``, x, y, x, y, radius
 * @property {number[][]} team x, y, theta of each teammate
 * @property {number[][]} path points of the global path that holds
 * @property {boolean} touching
 */

/** @typedef {{points: number[][], cost: number, chosen: boolean}} Candidate  cost: Infinity for what is refused */
/** @typedef {{id: number, x: number, y: number, vx: number, vy: number, radius: number}} Track */

const KINDS = ["wall", "obstacle", "person", "robot"];

/**
 * @typedef {{kind: string, stamp: number, text: string, way: number[][]}} Mark  a moment that was found out; ``way``: a
 * way that was possible from then on
 */

const MOMENT = "last avoidable moment"; // the kind of the marks that have a way
const WAY_STEP = 0.25; // s between two places of a way
const WAY_AHEAD = 1; // s before its moment from which a way is shown

/** An angle between two, the short way round. @param {number} a @param {number} b @param {number} share */
export function turned(a, b, share) {
  const difference = Math.atan2(Math.sin(b - a), Math.cos(b - a));
  return a + share * difference;
}

/**
 * Legs between two rows; those of the first where the person is gone at the second.
 * @param {Float32Array} legs
 * @param {number} row
 * @param {number} next
 * @param {number} share
 */
function between(legs, row, next, share) {
  const [from, to] = [5 * row, 5 * (Number.isNaN(legs[5 * next]) ? row : next)];
  return [0, 1, 2, 3, 4].map((i) => legs[from + i] + share * (legs[to + i] - legs[from + i]));
}

export class Episode {
  /** @param {any} said an episode of the header @param {any[]} maps */
  constructor(said, maps) {
    /** @type {any} */ this.said = said;
    /** @type {Record<string, import("./decode.js").Table>} */ this.arrays = said.arrays;
    this.map = said.map === null ? null : maps[said.map];
    this.name = said.name;
    this.stamps = this.arrays.stamp.values;
    this.rows = this.arrays.stamp.rows;
    this.end = this.rows ? this.stamps[this.rows - 1] : 0;
    this.count = this.arrays.people.shape.length === 3 ? this.arrays.people.shape[0] : 0;
    this.contacts = this.#contacts();
    /** @type {Mark[]} */ this.marks = said.marks ?? [];
    this.moments = this.marks.filter((mark) => mark.kind === MOMENT);
    this.legs = Array.from({ length: this.count }, (_, person) => this.#legs(person));
  }

  /** Where a person's legs are at every row, null where the person has none. @param {number} person */
  #legs(person) {
    const begin = this.arrays.gait_begin;
    if (!this.said.gait || !begin) return null;
    const { values, rows } = this.arrays.people;
    const place = (/** @type {number} */ row) => [
      values[person * 2 * rows + row],
      values[(person * 2 + 1) * rows + row],
    ];
    const how = [begin.values[person], begin.values[begin.rows + person]];
    return walk(this.said.gait, this.stamps, place, this.arrays.radii.values[person], how);
  }

  /** The last row at or before a time. @param {number} time */
  rowAt(time) {
    let low = 0;
    let high = this.rows - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.stamps[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** One figure. @param {string} name @param {number} row @param {number} [component] */
  value(name, row, component = 0) {
    const { values, rows } = this.arrays[name];
    return values[component * rows + row];
  }

  /** Whether a door is open. @param {number} door its number @param {number} time */
  doorOpen(door, time) {
    return this.value("doors_open", this.rowAt(time), door) > 0;
  }

  /** @param {number} time @returns {Moment} */
  at(time) {
    const row = this.rowAt(time);
    const next = Math.min(row + 1, this.rows - 1);
    const span = this.stamps[next] - this.stamps[row];
    const share = span > 0 ? Math.min(1, Math.max(0, (time - this.stamps[row]) / span)) : 0;
    return {
      time,
      row,
      pose: this.#pose("pose", row, next, share),
      estimate: this.#pose("estimate", row, next, share),
      twist: [0, 1, 2].map((component) => this.value("twist", row, component)),
      people: this.#people(row, next, share),
      team: this.#team(row, next, share),
      path: this.#path(time),
      touching: this.value("in_contact", row) > 0,
    };
  }

  /** @param {string} name @param {number} row @param {number} next @param {number} share */
  #pose(name, row, next, share) {
    const [x, y] = [0, 1].map(
      (c) => this.value(name, row, c) + share * (this.value(name, next, c) - this.value(name, row, c)),
    );
    return [x, y, turned(this.value(name, row, 2), this.value(name, next, 2), share)];
  }

  /** @param {number} row @param {number} next @param {number} share */
  #team(row, next, share) {
    if (!this.arrays.team) return [];
    const { values, rows, shape } = this.arrays.team; // component-first: (teammates, 3, rows)
    return Array.from({ length: shape[0] }, (_, mate) => {
      const [from, to] = [row, next].map((at) => [0, 1, 2].map((c) => values[(mate * 3 + c) * rows + at]));
      const [x, y] = [0, 1].map((c) => from[c] + share * (to[c] - from[c]));
      return [x, y, turned(from[2], to[2], share)];
    });
  }

  /** @param {number} row @param {number} next @param {number} share */
  #people(row, next, share) {
    const { values, rows } = this.arrays.people; // component-first: (people, 2, rows)
    const found = [];
    const span = this.stamps[next] - this.stamps[row] || 1;
    for (let person = 0; person < this.count; person++) {
      const x = values[person * 2 * rows + row];
      const y = values[(person * 2 + 1) * rows + row];
      if (Number.isNaN(x)) continue;
      let dx = values[person * 2 * rows + next] - x;
      let dy = values[(person * 2 + 1) * rows + next] - y;
      if (Number.isNaN(dx)) dx = dy = 0;
      const radius = this.arrays.radii.values[person];
      const state = this.arrays.states.values[person * rows + row];
      const legs = this.legs[person] && between(/** @type {Float32Array} */ (this.legs[person]), row, next, share);
      found.push({
        number: person,
        x: x + share * dx,
        y: y + share * dy,
        vx: dx / span,
        vy: dy / span,
        radius,
        state,
        legs,
      });
    }
    return found;
  }

  /** @param {number} time */
  #path(time) {
    const { values: stamps, rows } = this.arrays.path_stamps;
    let latest = -1;
    for (let i = 0; i < rows && stamps[i] <= time + 1e-6; i++) latest = i;
    if (latest < 0) return [];
    const { values, rows: points } = this.arrays.path;
    const offsets = this.arrays.path_offsets.values;
    const found = [];
    for (let i = offsets[latest]; i < offsets[latest + 1]; i++) found.push([values[i], values[points + i]]);
    return found;
  }

  /** A scan that was kept, or null. @param {number} row @returns {Float32Array | null} */
  scan(row) {
    const kept = this.arrays.scan;
    if (!kept || !kept.rows) return null;
    const at = Math.min(row, kept.rows - 1);
    return Float32Array.from({ length: kept.shape[0] }, (_, beam) => kept.values[beam * kept.rows + at]);
  }

  /**
   * What the planner considered at a row; nothing where no record keeps it.
   * @param {number} row
   * @returns {Candidate[]}
   */
  considered(row) {
    const { considered_rows: rows, considered_offsets: offsets, considered_points: points } = this.arrays;
    const found = [];
    for (let way = rows?.values[row] ?? 0; way < (rows?.values[row + 1] ?? 0); way++) {
      const line = [];
      for (let i = offsets.values[way]; i < offsets.values[way + 1]; i++)
        line.push([points.values[i], points.values[points.rows + i]]);
      found.push({
        points: line,
        cost: this.value("considered_costs", way),
        chosen: this.value("considered_chosen", way) > 0,
      });
    }
    return found;
  }

  /** The tracks that the planner saw at a row. @param {number} row @returns {Track[]} */
  tracks(row) {
    const rows = this.arrays.track_rows;
    const found = [];
    for (let i = rows?.values[row] ?? 0; i < (rows?.values[row + 1] ?? 0); i++) {
      const [x, y, vx, vy] = ["track_positions", "track_velocities"].flatMap((name) => [
        this.value(name, i, 0),
        this.value(name, i, 1),
      ]);
      found.push({ id: this.value("track_ids", i), x, y, vx, vy, radius: this.value("track_radii", i) });
    }
    return found;
  }

  /** The way out that is shown at a time: that of the moment that came last, or is about to. @param {number} time */
  wayOut(time) {
    const near = this.moments.filter(
      ({ stamp, way }) => time >= stamp - WAY_AHEAD && time <= stamp + WAY_STEP * (way.length - 1),
    );
    return near.length ? near[near.length - 1].way : [];
  }

  /** What was touched, when, where, how fast, and whether the robot moved into it. */
  #contacts() {
    const {
      contact_stamp: stamps,
      contact_position: places,
      contact_kind: kinds,
      contact_speed: speeds,
      contact_caused: caused,
    } = this.arrays;
    return Array.from(stamps.values, (stamp, i) => ({
      stamp,
      x: places.values[i],
      y: places.values[places.rows + i],
      kind: KINDS[kinds.values[i]],
      speed: speeds ? speeds.values[i] : NaN,
      caused: !caused || caused.values[i] > 0,
    }));
  }

  /** Times of collisions, s. @returns {number[]} */
  get collisions() {
    return [...this.arrays.contact_stamp.values];
  }
}
