// The levels of a curriculum: columns with units and bounds, and what is done with rows. Nothing is changed in place.

/** @typedef {Record<string, number | null>} Level */
/**
 * @typedef {{key: string, title: string, unit: string, low: number, high?: number, step: number, whole?: boolean,
 * empty: string, meaning: string}} Column
 */

/** @type {Column[]} */
export const COLUMNS = [
  {
    key: "difficulty",
    title: "difficulty",
    unit: "",
    low: 0,
    high: 1,
    step: 0.1,
    empty: "as it is",
    meaning: "of a generated world; empty: the world as it is",
  },
  {
    key: "obstacles",
    title: "obstacles",
    unit: "",
    low: 0,
    step: 1,
    whole: true,
    empty: "",
    meaning: "static obstacles that are on no map",
  },
  { key: "pedestrians", title: "people", unit: "", low: 0, step: 1, whole: true, empty: "", meaning: "people" },
  {
    key: "pedestrian_speed",
    title: "their speed",
    unit: "m/s",
    low: 0.01,
    step: 0.1,
    empty: "",
    meaning: "greatest speed of people",
  },
  {
    key: "speed_share",
    title: "robot's share",
    unit: "",
    low: 0.01,
    high: 1,
    step: 0.1,
    empty: "",
    meaning: "share of its speed limits that the robot may drive",
  },
  {
    key: "min_distance",
    title: "from",
    unit: "m",
    low: 0.1,
    step: 1,
    empty: "the task's",
    meaning: "least straight distance from start to goal",
  },
  {
    key: "max_distance",
    title: "to",
    unit: "m",
    low: 0.1,
    step: 1,
    empty: "the task's",
    meaning: "greatest straight distance from start to goal",
  },
];
const FIRST = { difficulty: null, obstacles: 0, pedestrians: 0, pedestrian_speed: 0.3, speed_share: 1 };
const OPTIONAL = ["min_distance", "max_distance"];

/** @param {Level[]} levels @param {number} at @returns {Level[]} with a copy of the level before at this place */
export function inserted(levels, at) {
  const level = { ...(levels[at - 1] ?? levels[at] ?? FIRST) };
  return [...levels.slice(0, at), level, ...levels.slice(at)];
}

/** @param {Level[]} levels @param {number} at @returns {Level[]} */
export function removed(levels, at) {
  return levels.filter((_, index) => index !== at);
}

/** @param {Level[]} levels @param {number} at @param {number} by @returns {Level[]} */
export function shifted(levels, at, by) {
  const to = at + by;
  if (to < 0 || to >= levels.length) return levels;
  const after = [...levels];
  [after[at], after[to]] = [after[to], after[at]];
  return after;
}

/**
 * @param {Level[]} levels
 * @param {number} at
 * @param {string} key
 * @param {number | null} value null: left open
 * @returns {Level[]}
 */
export function changed(levels, at, key, value) {
  return levels.map((level, index) => {
    if (index !== at) return level;
    if (value === null && OPTIONAL.includes(key)) {
      const { [key]: _left, ...rest } = level;
      return rest;
    }
    return { ...level, [key]: value };
  });
}

/**
 * How a column goes over the levels, for a plot: values with gaps where it is open, and what they reach to.
 * @param {Level[]} levels
 * @param {Column} column
 */
export function course(levels, column) {
  const values = levels.map((level) => level[column.key] ?? null);
  const known = /** @type {number[]} */ (values.filter((value) => value !== null));
  return { values, most: Math.max(column.high ?? 0, ...known, column.step), known: known.length > 0 };
}

/**
 * The points of a line of steps, in 0 .. 1 both ways; several where there are gaps.
 * @param {(number | null)[]} values
 * @param {number} most
 * @returns {[number, number][][]}
 */
export function steps(values, most) {
  /** @type {[number, number][][]} */ const lines = [];
  /** @type {[number, number][] | null} */ let line = null;
  values.forEach((value, at) => {
    if (value === null) return void (line = null);
    if (!line) lines.push((line = []));
    const height = Math.max(value, 0) / most; // what is wrong is told elsewhere
    line.push([at / values.length, height], [(at + 1) / values.length, height]);
  });
  return lines;
}
