// The fields of each kind of thing: what they are called, their units and bounds, and how they are read and written.

import { RADIUS, SPEED } from "studio/scenario/model.js";
import { withZone, withoutZone, zonesOf } from "studio/scenario/zones.js";

/**
 * @typedef {object} Entry
 * @property {string} name
 * @property {string} [unit]
 * @property {number | string | undefined} value
 * @property {number | string} [usual] what holds where it is empty
 * @property {number} [low]
 * @property {number} [high]
 * @property {number} [step]
 * @property {boolean} [text]
 * @property {(string | number)[]} [choices]
 * @property {string[]} [names] of the choices
 * @property {string} [meaning]
 * @property {boolean} [whole] a whole number
 * @property {(value: any) => any} write the thing with another value; undefined: empty
 */

const METRES = { unit: "m", step: 0.05 };

/**
 * @param {string} name
 * @param {number[]} at
 * @param {number} axis
 * @param {(at: number[]) => any} write
 * @returns {Entry}
 */
function coordinate(name, at, axis, write) {
  return {
    name,
    ...METRES,
    value: at[axis],
    write: (value) => write(at.map((old, index) => (index === axis ? (value ?? 0) : old))),
  };
}

/** @param {string} key @param {any} value @param {Partial<Entry> & {name: string}} facts @returns {Entry} */
function plain(key, value, facts) {
  return { value: value[key], ...facts, write: (given) => withKey(value, key, given) };
}

/** An object with a key set, or without it. @param {any} value @param {string} key @param {any} given */
export function withKey(value, key, given) {
  const after = { ...value };
  if (given === undefined || given === "") delete after[key];
  else after[key] = given;
  return after;
}

/**
 * Degrees are what one reads; files have radians.
 * @param {string} name
 * @param {number[]} pose
 * @param {(pose: number[]) => any} write
 * @returns {Entry}
 */
function heading(name, pose, write) {
  const degrees = Math.round(((pose[2] ?? 0) * 1800) / Math.PI) / 10;
  return {
    name,
    unit: "°",
    step: 5,
    value: degrees,
    write: (value) => write([pose[0], pose[1], Math.round(((value ?? 0) * Math.PI * 1e6) / 180) / 1e6]),
  };
}

/**
 * @param {import("./model.js").Thing["kind"]} kind
 * @param {any} value
 * @param {Record<string, any[]>} furniture
 * @returns {Entry[]}
 */
export function entriesOf(kind, value, furniture) {
  if (kind === "start")
    return [
      coordinate("x", value, 0, (at) => at),
      coordinate("y", value, 1, (at) => at),
      heading("heading", value, (pose) => pose),
    ];
  if (kind === "goal") return [coordinate("x", value, 0, (at) => at), coordinate("y", value, 1, (at) => at)];
  if (kind === "furniture") {
    const write = (/** @type {number[]} */ pose) => ({ ...value, pose });
    const what = {
      name: "kind",
      value: value.kind,
      choices: Object.keys(furniture),
      write: (/** @type {string} */ given) => ({ ...value, kind: given }),
    };
    return [
      what,
      coordinate("x", value.pose, 0, write),
      coordinate("y", value.pose, 1, write),
      heading("heading", value.pose, write),
    ];
  }
  if (kind === "pedestrians") return personEntries(value);
  if (value.vertices)
    return value.vertices.flatMap((/** @type {number[]} */ at, /** @type {number} */ corner) =>
      cornerEntries(value, "vertices", at, corner),
    );
  const write = (/** @type {number[]} */ center) => ({ ...value, center });
  return [
    coordinate("x", value.center, 0, write),
    coordinate("y", value.center, 1, write),
    plain("radius", value, { name: "radius", ...METRES, low: 0.01, high: 100 }),
  ];
}

/**
 * When a door is open; without an end it stays open.
 * @param {import("./model.js").Door} door
 * @returns {Entry[]}
 */
export function doorEntries(door) {
  const times = door.open.flatMap((pair, number) =>
    ["opens", "closes"].map((said, end) => ({
      name: door.open.length > 1 ? `${said} ${number}` : said,
      unit: "s",
      low: 0,
      step: 0.5,
      value: pair[end],
      usual: end ? "stays open" : undefined,
      meaning: "since the episode began",
      write: (/** @type {number | undefined} */ given) => withTime(door, number, end, given),
    })),
  );
  const again = { name: "again every", unit: "s", low: 0.1, step: 1, usual: "never", meaning: "empty: it opens once" };
  return [...times, plain("period", door, again)];
}

/**
 * @param {import("./model.js").Door} door
 * @param {number} number of the interval
 * @param {number} end 0: when it begins, 1: when it ends
 * @param {number | undefined} given
 */
function withTime(door, number, end, given) {
  const changed = (/** @type {number[]} */ [from, to]) =>
    [end ? from : (given ?? 0), end ? given : to].filter((time) => time !== undefined);
  return { ...door, open: door.open.map((pair, at) => (at === number ? changed(pair) : pair)) };
}

/**
 * @param {any} value
 * @param {"vertices" | "waypoints"} list
 * @param {number[]} at
 * @param {number} number
 * @returns {Entry[]}
 */
export function cornerEntries(value, list, at, number) {
  const write = (/** @type {number[]} */ to) => ({
    ...value,
    [list]: value[list].map((/** @type {any} */ old, /** @type {number} */ index) => (index === number ? to : old)),
  });
  return ["x", "y"].map((axis, index) =>
    coordinate(`${axis} of ${list === "vertices" ? "corner" : "waypoint"} ${number}`, at, index, write),
  );
}

/** @param {import("./model.js").Person} person @returns {Entry[]} */
function personEntries(person) {
  const write = (/** @type {any} */ position) => ({ ...person, position });
  return [
    coordinate("x", person.position, 0, write),
    coordinate("y", person.position, 1, write),
    plain("desired_speed", person, {
      name: "speed",
      unit: "m/s",
      low: 0.01,
      high: 5,
      step: 0.05,
      usual: SPEED,
      meaning: "its greatest speed; empty: the task's",
    }),
    plain("radius", person, {
      name: "radius",
      unit: "m",
      low: 0.05,
      high: 2,
      step: 0.05,
      usual: RADIUS,
      meaning: "empty: the task's",
    }),
  ];
}

/**
 * What a person does, of what the table of behaviour offers.
 * @param {import("./model.js").Person} person
 * @param {Record<string, any>} table
 * @returns {Entry[]}
 */
export function behaviourEntries(person, table) {
  const behaviour = person.behaviour ?? {};
  return Object.entries(table).map(([key, facts]) => ({
    ...facts,
    name: key.replaceAll("_", " "),
    value: behaviour[key],
    write: (/** @type {any} */ given) => ({ ...person, behaviour: withKey(behaviour, key, given) }),
  }));
}

/**
 * Keys of behaviour that the table has not; other models of people may know them.
 * @param {import("./model.js").Person} person
 * @param {Record<string, any>} table
 * @returns {Entry[]}
 */
export function otherEntries(person, table) {
  const behaviour = person.behaviour ?? {};
  const keys = Object.keys(behaviour).filter((key) => !(key in table) && !key.startsWith("trigger_zone_"));
  return keys.map((key) => ({
    name: key,
    text: typeof behaviour[key] === "string",
    step: 0.1,
    value: behaviour[key],
    write: (given) => ({ ...person, behaviour: withKey(behaviour, key, given) }),
  }));
}

/** @param {import("./model.js").Person} person @returns {{number: number, entries: Entry[], without: () => any}[]} */
export function zoneEntries(person) {
  return zonesOf(person).map((zone) => ({
    number: zone.number,
    entries: /** @type {const} */ (["x", "y", "radius"]).map((key) => ({
      name: `${key} of zone ${zone.number}`,
      ...METRES,
      ...(key === "radius" && { low: 0.05, high: 1000 }),
      value: zone[key],
      write: (given) => withZone(person, { ...zone, [key]: given ?? zone[key] }),
    })),
    without: () => withoutZone(person, zone.number),
  }));
}

/** The scene's own. @param {import("./model.js").Scene} scene @returns {Entry[]} */
export function sceneEntries(scene) {
  return [
    {
      ...plain("name", scene, { name: "name", text: true }),
      write: (given) => (given ? { ...scene, name: given } : scene),
    },
    plain("time_limit", scene, {
      name: "time limit",
      unit: "s",
      low: 0.1,
      step: 10,
      usual: 180,
      meaning: "empty: the task's",
    }),
    plain("goal_radius", scene, {
      name: "goal radius",
      unit: "m",
      low: 0.01,
      step: 0.05,
      usual: 0.3,
      meaning: "empty: the task's",
    }),
    plain("repeats", scene, {
      name: "repeats",
      unit: "",
      low: 1,
      step: 1,
      usual: 1,
      whole: true,
      meaning: "how often it comes before the next scene",
    }),
  ];
}
