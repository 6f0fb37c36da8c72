// Handles: the points of a scene that can be taken and moved, and which of them lies under the pointer.

import { RADIUS, things, valueOf, withValue } from "studio/scenario/model.js";
import { withZone, zonesOf } from "studio/scenario/zones.js";

/** @typedef {import("./model.js").Scene} Scene */
/** @typedef {import("./model.js").Thing} Thing */
/** @typedef {import("./model.js").Point} Point */
/**
 * @typedef {{thing: Thing, part: string, number: number, point: Point, reach: number}} Handle  `reach` m around it that
 * belong to it
 */

export const ARM = 0.7; // m from a pose to the handle of its heading

/** The tip of a heading. @param {number[]} pose @param {number} [arm] @returns {Point} */
export function tip([x, y, theta = 0], arm = ARM) {
  return [x + arm * Math.cos(theta), y + arm * Math.sin(theta)];
}

/**
 * The handles of one thing; those of a detail only where it is chosen.
 * @param {Scene} scene
 * @param {Thing} thing
 * @param {boolean} chosen
 * @returns {Handle[]}
 */
export function handlesOf(scene, thing, chosen) {
  const value = valueOf(scene, thing);
  /** @param {string} part @param {number[]} point @param {number} [number] @param {number} [reach] @returns {Handle} */
  const handle = (part, point, number = 0, reach = 0) => ({ thing, part, number, point: [point[0], point[1]], reach });
  if (thing.kind === "start")
    return [handle("place", value, 0, 0.25), ...(chosen ? [handle("heading", tip(value))] : [])];
  if (thing.kind === "goal") return [handle("place", value, 0, scene.goal_radius ?? 0.3)];
  if (thing.kind === "furniture")
    return [handle("place", value.pose, 0, 0.35), ...(chosen ? [handle("heading", tip(value.pose))] : [])];
  if (thing.kind === "pedestrians") return personHandles(value, chosen, handle);
  if (value.vertices) {
    const corners = chosen
      ? value.vertices.map((/** @type {Point} */ point, /** @type {number} */ at) => handle("corner", point, at))
      : [];
    return [...corners, handle("place", middle(value.vertices))];
  }
  return [
    handle("place", value.center, 0, value.radius),
    ...(chosen ? [handle("rim", [value.center[0] + value.radius, value.center[1]])] : []),
  ];
}

/**
 * @param {import("./model.js").Person} person
 * @param {boolean} chosen
 * @param {(part: string, point: number[], number?: number, reach?: number) => Handle} handle
 */
function personHandles(person, chosen, handle) {
  const ways = (person.waypoints ?? []).map((point, at) => handle("waypoint", point, at));
  const place = handle("place", person.position, 0, person.radius ?? RADIUS);
  if (!chosen) return [place, ...ways];
  const zones = zonesOf(person).flatMap((zone) => [
    handle("zone", [zone.x, zone.y], zone.number),
    handle("zone rim", [zone.x + zone.radius, zone.y], zone.number),
  ]);
  return [...ways, place, ...zones]; // the person lies above a zone that is around it
}

/**
 * The handle under a point; those of the chosen thing go first.
 * @param {Scene} scene
 * @param {Point} point
 * @param {number} near m
 * @param {Thing | null} chosen
 * @returns {Handle | null}
 */
export function handleAt(scene, [x, y], near, chosen) {
  const isChosen = (/** @type {Thing} */ thing) => thing.kind === chosen?.kind && thing.index === chosen.index;
  const all = things(scene).flatMap((thing) => handlesOf(scene, thing, isChosen(thing)));
  let best = null;
  let least = Infinity;
  for (const handle of all) {
    const far = Math.hypot(handle.point[0] - x, handle.point[1] - y);
    const order = Math.max(far - handle.reach, 0) - (isChosen(handle.thing) ? near : 0) + 1e-3 * far;
    if (far <= Math.max(near, handle.reach) && order < least) [best, least] = [handle, order];
  }
  return best ?? polygonAt(scene, [x, y]);
}

/** @param {Scene} scene @param {Point} point @returns {Handle | null} */
function polygonAt(scene, point) {
  for (const kind of /** @type {const} */ (["doors", "obstacles"])) {
    const all = scene[kind] ?? [];
    const index = all.findIndex(({ vertices }) => vertices && inside(vertices, point));
    const { vertices } = all[index] ?? {};
    if (vertices) return { thing: { kind, index }, part: "place", number: 0, point: middle(vertices), reach: 0 };
  }
  return null;
}

/**
 * The scene with a handle moved to a point.
 * @param {Scene} scene
 * @param {Handle} handle
 * @param {Point} to
 * @returns {Scene}
 */
export function moved(scene, handle, to) {
  const value = valueOf(scene, handle.thing);
  return withValue(scene, handle.thing, changed(value, handle, to.map(rounded)));
}

/** @param {any} value @param {Handle} handle @param {number[]} to */
function changed(value, { thing, part, number }, to) {
  const angle = (/** @type {number[]} */ from) => rounded(Math.atan2(to[1] - from[1], to[0] - from[0]));
  const far = (/** @type {number[]} */ from) => Math.max(rounded(Math.hypot(to[0] - from[0], to[1] - from[1])), 0.05);
  if (thing.kind === "start" || thing.kind === "goal")
    return part === "heading" ? [value[0], value[1], angle(value)] : [...to, ...value.slice(2)];
  if (thing.kind === "furniture")
    return {
      ...value,
      pose: part === "heading" ? [value.pose[0], value.pose[1], angle(value.pose)] : [...to, value.pose[2] ?? 0],
    };
  if (part === "waypoint" || part === "corner") {
    const name = part === "waypoint" ? "waypoints" : "vertices";
    return {
      ...value,
      [name]: value[name].map((/** @type {Point} */ old, /** @type {number} */ at) => (at === number ? to : old)),
    };
  }
  if (part.startsWith("zone")) {
    const zone = /** @type {import("./zones.js").Zone} */ (zonesOf(value).find((one) => one.number === number));
    return withZone(
      value,
      part === "zone" ? { ...zone, x: to[0], y: to[1] } : { ...zone, radius: far([zone.x, zone.y]) },
    );
  }
  if (part === "rim") return { ...value, radius: far(value.center) };
  if (value.position) return { ...value, position: to };
  if (value.center) return { ...value, center: to };
  const from = middle(value.vertices);
  return {
    ...value,
    vertices: value.vertices.map((/** @type {Point} */ [x, y]) => [
      rounded(x + to[0] - from[0]),
      rounded(y + to[1] - from[1]),
    ]),
  };
}

/** A millimetre is as fine as anybody places things by hand. @param {number} value */
export function rounded(value) {
  return Math.round(1000 * value) / 1000;
}

/** @param {Point[]} vertices @returns {Point} */
export function middle(vertices) {
  const mean = (/** @type {number} */ axis) =>
    vertices.reduce((sum, vertex) => sum + vertex[axis], 0) / vertices.length;
  return [mean(0), mean(1)];
}

/** Whether a point lies in a polygon. @param {Point[]} vertices @param {Point} point */
export function inside(vertices, [x, y]) {
  let odd = false;
  for (let i = 0, j = vertices.length - 1; i < vertices.length; j = i++) {
    const [[a, b], [c, d]] = [vertices[i], vertices[j]];
    if (b > y !== d > y && x < ((c - a) * (y - b)) / (d - b) + a) odd = !odd;
  }
  return odd;
}
