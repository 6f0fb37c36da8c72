// The tools of the scenario editor: choose and move, and one for each thing that can be placed.

import { PAN } from "studio/edit/tools.js";
import { handleAt, moved, rounded } from "studio/scenario/handles.js";
import { added, RADIUS, titleOf, valueOf, withValue, without } from "studio/scenario/model.js";
import { placed } from "studio/scenario/placing.js";
import { withZone } from "studio/scenario/zones.js";

/** @typedef {import("../edit/tools.js").Tool} Tool */
/** @typedef {import("./editor.js").Editor} Editor */
/** @typedef {[number, number]} Point */

const NEAR = 10; // pixels from a handle that still take it
const FINGER = 22;

/** All tools. @param {Editor} editor @param {import("../edit/view.js").View} view @returns {Tool[]} */
export function toolsOf(editor, view) {
  return [
    chooser(editor, view),
    ends(editor, "start"),
    ends(editor, "goal"),
    people(editor),
    disc(editor),
    polygon(editor, view),
    door(editor),
    zone(editor),
    furniture(editor),
    PAN,
  ];
}

/**
 * How much room a thing needs, m.
 * @param {Editor} editor
 * @param {import("./model.js").Thing["kind"]} kind
 * @param {any} value
 */
function roomOf(editor, kind, value) {
  if (kind === "start" || kind === "goal") return editor.robot?.footprint?.radius ?? 0.2;
  return kind === "pedestrians" ? (value?.radius ?? RADIUS) : 0;
}

/** @param {Editor} editor @param {import("../edit/view.js").View} view @returns {Tool} */
function chooser(editor, view) {
  /** @type {import("./handles.js").Handle | null} */ let held = null;
  let off = [0, 0];
  let went = false;
  return {
    name: "choose",
    title: "Choose and move; Delete removes",
    key: "v",
    cursor: "default",
    down(hand) {
      if (!editor.content) return;
      held = handleAt(editor.scene, hand.point, (hand.touch ? FINGER : NEAR) * view.pixel, editor.chosen);
      if (held) off = [held.point[0] - hand.point[0], held.point[1] - hand.point[1]];
      went = false;
      editor.choose(held?.thing ?? null);
    },
    move(hand) {
      if (!held) return;
      const to = /** @type {Point} */ ([hand.point[0] + off[0], hand.point[1] + off[1]]);
      const free = held.part === "place" || held.part === "waypoint";
      const room = free ? roomOf(editor, held.thing.kind, valueOf(editor.scene, held.thing)) : 0;
      went = true;
      editor.drag(
        moved(editor.scene, held, held.part === "heading" ? to : placed(editor, { point: to, alt: hand.alt }, room)),
      );
    },
    up() {
      if (held && went) editor.drop(`move ${titleOf(editor.scene, held.thing)}`);
      held = null;
    },
    cancel() {
      held = null;
      editor.cancel();
    },
    press: (event) => chosenKey(editor, event),
  };
}

/** Keys for what is chosen: Delete removes it, d doubles it. @param {Editor} editor @param {KeyboardEvent} event */
function chosenKey(editor, event) {
  const thing = editor.chosen;
  if (!thing || !editor.content) return false;
  if (event.key === "Delete" || event.key === "Backspace") return (remove(editor), true);
  if (event.key !== "d" || thing.kind === "start" || thing.kind === "goal") return false;
  const { kind } = thing;
  const value = valueOf(editor.scene, thing);
  editor.change(`double ${titleOf(editor.scene, thing)}`, (scene) => shifted(added(scene, kind, value), kind));
  editor.choose({ kind, index: (editor.scene[kind]?.length ?? 1) - 1 });
  return true;
}

/**
 * The scene with the last of a list half a metre aside.
 * @param {import("./model.js").Scene} scene
 * @param {"pedestrians" | "obstacles" | "doors" | "furniture"} kind
 */
function shifted(scene, kind) {
  const thing = { kind, index: (scene[kind]?.length ?? 1) - 1 };
  const value = valueOf(scene, thing);
  const by = (/** @type {number[]} */ [x, y, ...rest]) => [rounded(x + 0.5), rounded(y - 0.5), ...rest];
  const keys = /** @type {const} */ (["position", "center", "pose"]);
  const key = keys.find((name) => value[name]);
  if (key) return withValue(scene, thing, { ...value, [key]: by(value[key]) });
  return withValue(scene, thing, { ...value, vertices: value.vertices.map(by) });
}

/** Remove what is chosen; start and goal stay. @param {Editor} editor */
export function remove(editor) {
  const thing = editor.chosen;
  if (!thing || thing.kind === "start" || thing.kind === "goal") return;
  editor.change(`remove ${titleOf(editor.scene, thing)}`, (scene) => without(scene, thing));
  editor.choose(null);
}

/**
 * Press where it stands, drag in the direction it faces.
 * @param {Editor} editor
 * @param {"start" | "goal"} kind
 * @returns {Tool}
 */
function ends(editor, kind) {
  const thing = { kind, index: 0 };
  /** @type {Point | null} */ let from = null;
  const what = kind === "start" ? "robot's start" : "goal";
  return {
    name: kind,
    title: kind === "start" ? "The robot's start: click to place, drag in the direction it faces" : "The goal",
    key: kind === "start" ? "s" : "g",
    cursor: "crosshair",
    down(hand) {
      if (!editor.content) return;
      const room = roomOf(editor, kind, null);
      from = placed(editor, hand, room);
      const [x, y] = from.map(rounded);
      editor.choose(thing);
      editor.drag(withValue(editor.scene, thing, kind === "start" ? [x, y, editor.scene.start[2] ?? 0] : [x, y]));
    },
    move(hand) {
      if (!from || kind === "goal") return;
      const [dx, dy] = [hand.point[0] - from[0], hand.point[1] - from[1]];
      if (Math.hypot(dx, dy) < 0.15) return;
      const eighth = Math.PI / (hand.alt ? 180 : 12);
      const theta = rounded(eighth * Math.round(Math.atan2(dy, dx) / eighth));
      editor.drag(withValue(editor.scene, thing, [...editor.scene.start.slice(0, 2), theta]));
    },
    up() {
      from = null;
      editor.drop(`place the ${what}`);
    },
    cancel() {
      from = null;
      editor.cancel();
    },
  };
}

/**
 * The first click places a person, each further one a waypoint; Enter, Escape or a double click ends the round.
 * @param {Editor} editor
 * @returns {Tool}
 */
function people(editor) {
  /** @type {import("./model.js").Thing | null} */ let walker = null;
  const end = () => {
    walker = null;
    editor.show();
  };
  /** @param {import("../edit/tools.js").Hand} hand */
  const down = (hand) => {
    if (!editor.content) return;
    if (walker && (hand.double || valueOf(editor.scene, walker) === undefined)) return end();
    const at = /** @type {Point} */ (placed(editor, hand, RADIUS).map(rounded));
    if (walker) {
      const person = valueOf(editor.scene, walker);
      const thing = walker;
      editor.change("add a waypoint", (scene) =>
        withValue(scene, thing, { ...person, waypoints: [...(person.waypoints ?? []), at] }),
      );
      return;
    }
    walker = { kind: "pedestrians", index: editor.scene.pedestrians?.length ?? 0 };
    editor.change("add a person", (scene) => added(scene, "pedestrians", { position: at, waypoints: [] }));
    editor.choose(walker);
  };
  return {
    name: "person",
    title: "A person: click where it starts, then each waypoint; Escape or a double click ends its round",
    key: "p",
    cursor: "crosshair",
    down,
    cancel: end,
    press: (event) =>
      walker !== null && event.key === "Enter" && event.target instanceof HTMLBodyElement && (end(), true),
    draw(context, view) {
      if (walker) badge(context, view, "click: next waypoint · Escape: done");
    },
  };
}

/** @param {CanvasRenderingContext2D} context @param {import("../edit/view.js").View} view @param {string} text */
function badge(context, view, text) {
  context.save();
  context.setTransform(view.ratio, 0, 0, view.ratio, 0, 0);
  context.font = "13px system-ui, sans-serif";
  const width = context.measureText(text).width + 16;
  context.fillStyle = "rgba(20, 24, 28, 0.85)";
  context.fillRect(8, 8, width, 26);
  context.fillStyle = "#ffffff";
  context.fillText(text, 16, 26);
  context.restore();
}

/** @param {Editor} editor @returns {Tool} */
function disc(editor) {
  /** @type {Point | null} */ let from = null;
  return {
    name: "disc",
    title: "A round obstacle: press in its middle, drag to its rim",
    key: "c",
    cursor: "crosshair",
    down(hand) {
      if (editor.content) from = placed(editor, hand);
    },
    move(hand) {
      if (!from || !editor.content) return;
      const radius = Math.max(rounded(Math.hypot(hand.point[0] - from[0], hand.point[1] - from[1])), 0.05);
      const base = editor.before ? editor.before.scenarios[editor.at] : editor.scene;
      editor.drag(added(base, "obstacles", { center: from.map(rounded), radius }));
    },
    up() {
      if (!from) return;
      if (editor.before) editor.drop("add a disc");
      else
        editor.change("add a disc", (scene) =>
          added(scene, "obstacles", { center: /** @type {Point} */ (from).map(rounded), radius: 0.3 }),
        );
      editor.choose({ kind: "obstacles", index: (editor.scene.obstacles?.length ?? 1) - 1 });
      from = null;
    },
    cancel() {
      from = null;
      editor.cancel();
    },
  };
}

/**
 * Each click is a corner; a double click, Enter or the first corner closes it.
 * @param {Editor} editor
 * @param {import("../edit/view.js").View} view
 * @returns {Tool}
 */
function polygon(editor, view) {
  /** @type {Point[]} */ let corners = [];
  /** @type {Point | null} */ let over = null;
  const close = () => {
    const vertices = corners;
    corners = [];
    if (vertices.length < 3) return;
    editor.change("add a polygon", (scene) => added(scene, "obstacles", { vertices }));
    editor.choose({ kind: "obstacles", index: (editor.scene.obstacles?.length ?? 1) - 1 });
  };
  return {
    name: "polygon",
    title: "An obstacle with corners: click each; a double click, Enter or the first corner closes it",
    key: "o",
    cursor: "crosshair",
    down(hand) {
      if (!editor.content) return;
      const at = /** @type {Point} */ (placed(editor, hand).map(rounded));
      const first = corners[0];
      if (hand.double || (first && Math.hypot(first[0] - at[0], first[1] - at[1]) < NEAR * view.pixel)) return close();
      corners = [...corners, at];
    },
    hover(hand) {
      over = placed(editor, hand);
    },
    cancel() {
      corners = [];
    },
    press: (event) => event.key === "Enter" && corners.length > 2 && (close(), true),
    draw(context) {
      if (!corners.length) return;
      context.beginPath();
      for (const [x, y] of over ? [...corners, over] : corners) context.lineTo(x, y);
      context.lineWidth = 2 * view.pixel;
      context.strokeStyle = "#0072B2";
      context.stroke();
      for (const [x, y] of corners)
        context.fillRect(x - 3 * view.pixel, y - 3 * view.pixel, 6 * view.pixel, 6 * view.pixel);
    },
  };
}

const THICK = 0.1; // m, of a new door
const OPENS = 5; // s, when it opens

/** A door from one post to the other, that opens once. @param {Editor} editor @returns {Tool} */
function door(editor) {
  /** @type {Point | null} */ let from = null;
  return {
    name: "door",
    title: "A door, closed at first: press at one post, drag to the other; when it opens is written beside the map",
    key: "e",
    cursor: "crosshair",
    down(hand) {
      if (editor.content) from = placed(editor, hand);
    },
    move(hand) {
      if (!from || !editor.content) return;
      const to = placed(editor, hand);
      if (Math.hypot(to[0] - from[0], to[1] - from[1]) < THICK) return;
      const base = editor.before ? editor.before.scenarios[editor.at] : editor.scene;
      editor.drag(added(base, "doors", { vertices: leaf(from, to), open: [[OPENS]] }));
    },
    up() {
      if (from && editor.before) {
        editor.drop("add a door");
        editor.choose({ kind: "doors", index: (editor.scene.doors?.length ?? 1) - 1 });
      }
      from = null;
    },
    cancel() {
      from = null;
      editor.cancel();
    },
  };
}

/** The outline of a door between two posts. @param {Point} from @param {Point} to @returns {Point[]} */
export function leaf(from, to) {
  const half = THICK / 2 / Math.hypot(to[0] - from[0], to[1] - from[1]);
  const [ox, oy] = [-half * (to[1] - from[1]), half * (to[0] - from[0])];
  const at = (/** @type {Point} */ [x, y], /** @type {number} */ side) =>
    /** @type {Point} */ ([rounded(x + side * ox), rounded(y + side * oy)]);
  return [at(from, -1), at(to, -1), at(to, 1), at(from, 1)];
}

/** A zone that starts the chosen person once the robot is in it. @param {Editor} editor @returns {Tool} */
function zone(editor) {
  /** @type {Point | null} */ let from = null;
  const person = () => (editor.chosen?.kind === "pedestrians" ? editor.chosen : null);
  /** @param {Point} middle @param {number} radius */
  const make = (middle, radius) => {
    const thing = /** @type {import("./model.js").Thing} */ (person());
    const base = editor.before ? editor.before.scenarios[editor.at] : editor.scene;
    const [x, y] = middle.map(rounded);
    return withValue(base, thing, withZone(valueOf(base, thing), { number: 0, x, y, radius: rounded(radius) }));
  };
  return {
    name: "zone",
    title:
      "A trigger zone of the chosen person: the robot in it starts the person. Press in its middle, drag to its rim",
    key: "z",
    cursor: "crosshair",
    down(hand) {
      if (!editor.content) return;
      if (!person())
        return editor.context.say("Choose a person first: a zone starts that person once the robot is in it.", "error");
      from = placed(editor, hand);
      editor.drag(make(from, 1.5));
    },
    move(hand) {
      if (from) editor.drag(make(from, Math.max(Math.hypot(hand.point[0] - from[0], hand.point[1] - from[1]), 0.2)));
    },
    up() {
      if (from) editor.drop("add a zone");
      from = null;
    },
    cancel() {
      from = null;
      editor.cancel();
    },
  };
}

/** @param {Editor} editor @returns {Tool} */
function furniture(editor) {
  /** @type {Point | null} */ let from = null;
  const kind = () => editor.piece ?? Object.keys(editor.kinds.furniture)[0];
  return {
    name: "furniture",
    title: "A piece of furniture: click to place, drag in the direction it faces",
    key: "f",
    cursor: "crosshair",
    down(hand) {
      if (!editor.content || !kind()) return;
      from = placed(editor, hand);
      editor.drag(added(editor.scene, "furniture", { kind: kind(), pose: [...from.map(rounded), 0] }));
      editor.choose({ kind: "furniture", index: (editor.scene.furniture?.length ?? 1) - 1 });
    },
    move(hand) {
      if (!from || !editor.chosen) return;
      const [dx, dy] = [hand.point[0] - from[0], hand.point[1] - from[1]];
      if (Math.hypot(dx, dy) < 0.2) return;
      const eighth = Math.PI / (hand.alt ? 180 : 12);
      const theta = rounded(eighth * Math.round(Math.atan2(dy, dx) / eighth));
      editor.drag(withValue(editor.scene, editor.chosen, { kind: kind(), pose: [...from.map(rounded), theta] }));
    },
    up() {
      if (from) editor.drop("add furniture");
      from = null;
    },
    cancel() {
      from = null;
      editor.cancel();
    },
  };
}
