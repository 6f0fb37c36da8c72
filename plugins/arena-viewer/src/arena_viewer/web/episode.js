// One recorded episode that can be asked for any moment; between two control steps everything moves evenly.

/**
 * @typedef {object} Moment
 * @property {number} row the control step that holds
 * @property {number[]} pose x, y, theta
 * @property {number[]} estimate
 * @property {number[]} twist vx, vy, wz
 * @property {{x: number, y: number, vx: number, vy: number, radius: number, state: number}[]} people those who are in the world
 * @property {number[][]} path points of the global path that holds
 * @property {boolean} touching
 */

/** An angle between two, the short way round. @param {number} a @param {number} b @param {number} share */
export function turned(a, b, share) {
  const difference = Math.atan2(Math.sin(b - a), Math.cos(b - a));
  return a + share * difference;
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

  /** @param {number} time @returns {Moment} */
  at(time) {
    const row = this.rowAt(time);
    const next = Math.min(row + 1, this.rows - 1);
    const span = this.stamps[next] - this.stamps[row];
    const share = span > 0 ? Math.min(1, Math.max(0, (time - this.stamps[row]) / span)) : 0;
    return {
      row,
      pose: this.#pose("pose", row, next, share),
      estimate: this.#pose("estimate", row, next, share),
      twist: [0, 1, 2].map((component) => this.value("twist", row, component)),
      people: this.#people(row, next, share),
      path: this.#path(time),
      touching: this.value("in_contact", row) > 0,
    };
  }

  /** @param {string} name @param {number} row @param {number} next @param {number} share */
  #pose(name, row, next, share) {
    const [x, y] = [0, 1].map((c) => this.value(name, row, c) + share * (this.value(name, next, c) - this.value(name, row, c)));
    return [x, y, turned(this.value(name, row, 2), this.value(name, next, 2), share)];
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
      found.push({ x: x + share * dx, y: y + share * dy, vx: dx / span, vy: dy / span, radius, state });
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

  /** Times of collisions, s. @returns {number[]} */
  get collisions() {
    return [...this.arrays.contact_stamp.values];
  }
}
