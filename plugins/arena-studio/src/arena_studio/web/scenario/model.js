// The page's model of a scenario file: the suite's own format as it stands in the file. Nothing is changed in place.

/**
 * @typedef {[number, number]} Point  m
 * @typedef {Record<string, number | string>} Behaviour
 * @typedef {{position: Point, waypoints?: Point[], desired_speed?: number, radius?: number, behaviour?: Behaviour}}
 * Person
 * @typedef {{center?: Point, radius?: number, vertices?: Point[]}} Obstacle  a disc or a polygon
 * @typedef {{kind: string, pose: number[]}} Piece
 * @typedef {{vertices: Point[], open: number[][], period?: number}} Door  closed but in these intervals, s
 * @typedef {{name: string, repeats?: number, start: number[], goal: number[], goal_radius?: number, time_limit?:
 * number, pedestrians?: Person[],
 *   obstacles?: Obstacle[], doors?: Door[], furniture?: Piece[]}} Scene
 * @typedef {{format: string, version: number, title?: string, map?: string, scenarios: Scene[]}} Content
 * @typedef {{kind: "start" | "goal" | "pedestrians" | "obstacles" | "doors" | "furniture", index: number}} Thing
 */

export const SPEED = 0.3; // m/s and m: what task=scenario fills in where a file leaves them open
export const RADIUS = 0.3;
const LISTS = /** @type {const} */ (["pedestrians", "obstacles", "doors", "furniture"]);

/**
 * A scene that can be run in an empty place around a point.
 * @param {string} name
 * @param {Point} [at]
 * @returns {Scene}
 */
export function newScene(name, [x, y] = [1, 1]) {
  return { name, start: [x, y, 0], goal: [x + 3, y], pedestrians: [], obstacles: [] };
}

/** @param {Scene[]} scenes @param {string} [map] @param {string} [title] @returns {Content} */
export function newContent(scenes, map = "", title = "") {
  return { format: "arena-scenario", version: 2, ...(title && { title }), ...(map && { map }), scenarios: scenes };
}

/** A name that none of the others has: `name`, `name 2`, and so on. @param {string} name @param {string[]} others */
export function freeName(name, others) {
  const base = name.replace(/ \d+$/, "");
  for (let number = 1; ; number++) {
    const found = number === 1 ? name : `${base} ${number}`;
    if (!others.includes(found)) return found;
  }
}

/** @param {Content} content @param {number} at @param {Scene} scene @returns {Content} */
export function withScene(content, at, scene) {
  return { ...content, scenarios: content.scenarios.map((old, index) => (index === at ? scene : old)) };
}

/** All of a scene, start and goal first. @param {Scene} scene @returns {Thing[]} */
export function things(scene) {
  const ends = /** @type {Thing[]} */ ([
    { kind: "start", index: 0 },
    { kind: "goal", index: 0 },
  ]);
  return [...ends, ...LISTS.flatMap((kind) => (scene[kind] ?? []).map((_, index) => ({ kind, index })))];
}

/** What stands there; start and goal are poses. @param {Scene} scene @param {Thing} thing @returns {any} */
export function valueOf(scene, { kind, index }) {
  return kind === "start" || kind === "goal" ? scene[kind] : scene[kind]?.[index];
}

/** @param {Scene} scene @param {Thing} thing @param {any} value @returns {Scene} */
export function withValue(scene, { kind, index }, value) {
  if (kind === "start" || kind === "goal") return { ...scene, [kind]: value };
  return {
    ...scene,
    [kind]: (scene[kind] ?? []).map((/** @type {any} */ old, /** @type {number} */ at) => (at === index ? value : old)),
  };
}

/**
 * Put something new at the end of its list.
 * @param {Scene} scene
 * @param {"pedestrians" | "obstacles" | "doors" | "furniture"} kind
 * @param {any} value
 * @returns {Scene}
 */
export function added(scene, kind, value) {
  return { ...scene, [kind]: [...(scene[kind] ?? []), value] };
}

/** Take something away; start and goal stay. @param {Scene} scene @param {Thing} thing @returns {Scene} */
export function without(scene, { kind, index }) {
  if (kind === "start" || kind === "goal") return scene;
  return {
    ...scene,
    [kind]: (scene[kind] ?? []).filter((/** @type {any} */ _, /** @type {number} */ at) => at !== index),
  };
}

/** How a thing is called. @param {Scene} scene @param {Thing} thing */
export function titleOf(scene, thing) {
  const value = valueOf(scene, thing);
  if (thing.kind === "start") return "Robot's start";
  if (thing.kind === "goal") return "Goal";
  if (thing.kind === "pedestrians")
    return `Person ${thing.index}${value?.behaviour?.type ? `, ${value.behaviour.type}` : ""}`;
  if (thing.kind === "doors") return `Door ${thing.index}`;
  if (thing.kind === "furniture") return `${value?.kind ?? "furniture"} ${thing.index}`;
  return `${value?.vertices ? "Polygon" : "Disc"} ${thing.index}`;
}

/**
 * The thing that a key of the file names, such as `scenarios[1].pedestrians[0].position`.
 * @param {string} key
 * @returns {Thing | null}
 */
export function thingOf(key) {
  const found = /^scenarios\[\d+\]\.(start|goal|(pedestrians|obstacles|doors|furniture)\[(\d+)\])/.exec(key);
  if (!found) return null;
  return { kind: /** @type {Thing["kind"]} */ (found[2] ?? found[1]), index: Number(found[3] ?? 0) };
}

/** @param {Thing | null} a @param {Thing | null} b */
export function same(a, b) {
  return a?.kind === b?.kind && a?.index === b?.index;
}

/**
 * A path as it is written in a file of another folder; both are relative to the project.
 * @param {string} from the file
 * @param {string} to
 */
export function relativePath(from, to) {
  const [folder, target] = [from.split("/").slice(0, -1), to.split("/")];
  while (folder.length && target.length > 1 && folder[0] === target[0]) {
    folder.shift();
    target.shift();
  }
  return [...folder.map(() => ".."), ...target].join("/");
}
