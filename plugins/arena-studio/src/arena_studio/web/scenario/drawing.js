// Draws a scene in metres: obstacles and furniture, zones, rounds, people, goal and robot, handles of what is chosen,
// and what is wrong.

import { handlesOf, tip } from "studio/scenario/handles.js";
import { DOOR, faded, groupColours, ROBOT, TRIGGER } from "studio/scenario/looks.js";
import { RADIUS, same, thingOf } from "studio/scenario/model.js";
import { zonesOf } from "studio/scenario/zones.js";

/**
 * @typedef {Pick<import("./editor.js").Editor, "scene" | "chosen" | "findings" | "at">} Editor  what of an editor is
 * drawn
 */
/** @typedef {CanvasRenderingContext2D} Context */
/** @typedef {import("./looks.js").Colours} Colours */
/**
 * @typedef {{colours: Colours, pixel: number, furniture: Record<string, any[]>, robot: any, goalRadius: number}} Look
 */

/** @param {Context} context @param {Editor} editor @param {Look} look */
export function drawScene(context, editor, look) {
  const { scene, chosen } = editor;
  drawStanding(context, scene, look);
  const colours = groupColours(scene.pedestrians ?? []);
  for (const person of scene.pedestrians ?? []) drawZones(context, person, look);
  for (const [index, person] of (scene.pedestrians ?? []).entries()) {
    const colour = colours.get(String(person.behaviour?.group ?? "")) ?? look.colours.person;
    drawPerson(context, person, index, colour, look, same(chosen, { kind: "pedestrians", index }));
  }
  drawEnds(context, scene, look);
  if (chosen) drawHandles(context, editor, look);
  drawFindings(context, editor, look);
}

/**
 * Obstacles, closed doors and furniture.
 * @param {Context} context @param {import("./model.js").Scene} scene @param {Look} look
 */
export function drawStanding(context, scene, { colours, furniture }) {
  for (const { kind, pose } of scene.furniture ?? []) {
    context.save();
    context.translate(pose[0], pose[1]);
    context.rotate(pose[2] ?? 0);
    for (const { vertices_xy: vertices, radius, overhang } of furniture[kind] ?? [])
      shape(context, vertices, radius, overhang ? faded(colours.wall, 0.3) : colours.wall);
    context.restore();
  }
  for (const { center, radius, vertices } of scene.obstacles ?? [])
    shape(context, vertices ?? [/** @type {any} */ (center)], radius ?? 0, "#8a8a8d");
  for (const { vertices } of scene.doors ?? []) shape(context, vertices, 0, DOOR);
}

/** @param {Context} context @param {number[][]} vertices @param {number} radius @param {string} fill */
function shape(context, vertices, radius, fill) {
  context.beginPath();
  if (vertices.length < 3) context.arc(vertices[0][0], vertices[0][1], radius, 0, 2 * Math.PI);
  else for (const [x, y] of vertices) context.lineTo(x, y);
  context.closePath();
  context.fillStyle = fill;
  context.fill();
}

/** @param {Context} context @param {import("./model.js").Person} person @param {Look} look */
function drawZones(context, person, { pixel }) {
  for (const { x, y, radius } of zonesOf(person)) {
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fillStyle = faded(TRIGGER, 0.16);
    context.fill();
    stroke(context, TRIGGER, 1.2 * pixel, [3 * pixel, 3 * pixel]);
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(...person.position);
    stroke(context, TRIGGER, pixel, [2 * pixel, 3 * pixel]);
  }
}

/** @param {Context} context @param {string} colour @param {number} width @param {number[]} [dashes] */
function stroke(context, colour, width, dashes = []) {
  context.setLineDash(dashes);
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.stroke();
  context.setLineDash([]);
}

/**
 * @param {Context} context
 * @param {import("./model.js").Person} person
 * @param {number} index
 * @param {string} colour
 * @param {Look} look
 * @param {boolean} chosen
 */
function drawPerson(context, person, index, colour, { pixel, colours }, chosen) {
  const ways = person.waypoints ?? [];
  if (ways.length) {
    context.beginPath();
    for (const [x, y] of [person.position, ...ways, ways[0]]) context.lineTo(x, y);
    stroke(context, colour, (chosen ? 2.5 : 1.3) * pixel, [6 * pixel, 4 * pixel]);
    context.fillStyle = colour;
    for (const [x, y] of ways) context.fillRect(x - 3.5 * pixel, y - 3.5 * pixel, 7 * pixel, 7 * pixel);
  }
  const radius = Math.max(person.radius ?? RADIUS, 4 * pixel);
  context.beginPath();
  context.arc(...person.position, radius, 0, 2 * Math.PI);
  context.fillStyle = colour;
  context.fill();
  stroke(context, colours.paper, pixel);
  const type = String(person.behaviour?.type ?? "adult");
  label(context, type === "adult" ? String(index) : `${index} ${type}`, person.position, radius, pixel, colours);
}

/**
 * Text beside a point, upright.
 * @param {Context} context
 * @param {string} text
 * @param {number[]} at
 * @param {number} radius
 * @param {number} pixel
 * @param {Colours} colours
 */
function label(context, text, [x, y], radius, pixel, colours) {
  context.save();
  context.translate(x + 0.75 * radius, y + 0.75 * radius);
  context.scale(pixel, -pixel);
  context.font = "12px system-ui, sans-serif";
  context.fillStyle = faded(colours.paper, 0.8);
  context.fillRect(0, -12, context.measureText(text).width + 4, 15);
  context.fillStyle = colours.ink;
  context.fillText(text, 2, 0);
  context.restore();
}

/** @param {Context} context @param {import("./model.js").Scene} scene @param {Look} look */
function drawEnds(context, scene, { pixel, colours, robot, goalRadius }) {
  const [x, y] = scene.goal;
  context.beginPath();
  context.arc(x, y, scene.goal_radius ?? goalRadius, 0, 2 * Math.PI);
  context.fillStyle = faded(colours.goal, 0.45);
  context.fill();
  stroke(context, colours.ink, pixel);
  star(context, x, y, 8 * pixel);
  context.fillStyle = colours.goal;
  context.fill();
  stroke(context, colours.ink, 0.8 * pixel);
  drawRobot(context, scene.start, robot, pixel, ROBOT);
}

/**
 * @param {Context} context
 * @param {number[]} pose
 * @param {any} robot its body; null: a small disc
 * @param {number} pixel
 * @param {string} colour
 */
function drawRobot(context, pose, robot, pixel, colour) {
  const { vertices_xy: vertices = [], radius = 0.2 } = robot?.footprint ?? {};
  context.save();
  context.translate(pose[0], pose[1]);
  context.rotate(pose[2] ?? 0);
  shape(context, vertices.length ? vertices : [[0, 0]], radius, colour);
  context.restore();
  // a robot on a large map is too small to be seen: a ring, and an arrow that is as long as pixels say
  context.beginPath();
  context.arc(pose[0], pose[1], Math.max(radius, 9 * pixel), 0, 2 * Math.PI);
  stroke(context, colour, 1.5 * pixel);
  const length = Math.max(2 * radius, 22 * pixel);
  const end = tip(pose, length);
  context.beginPath();
  context.moveTo(pose[0], pose[1]);
  context.lineTo(...end);
  for (const side of [2.6, -2.6]) {
    const barb = tip([...end, (pose[2] ?? 0) + side], 7 * pixel);
    context.moveTo(...end);
    context.lineTo(...barb);
  }
  stroke(context, colour, 2 * pixel);
}

/** @param {Context} context @param {number} x @param {number} y @param {number} radius */
function star(context, x, y, radius) {
  context.beginPath();
  for (let k = 0; k < 10; k++) {
    const [far, angle] = [k % 2 ? 0.45 * radius : radius, Math.PI / 2 + (k * Math.PI) / 5];
    context.lineTo(x + far * Math.cos(angle), y + far * Math.sin(angle));
  }
  context.closePath();
}

/** @param {Context} context @param {Editor} editor @param {Look} look */
function drawHandles(context, editor, { pixel, colours }) {
  for (const { point, part, reach } of handlesOf(editor.scene, /** @type {any} */ (editor.chosen), true)) {
    context.beginPath();
    if (part === "place") context.arc(...point, Math.max(reach, 6 * pixel) + 3 * pixel, 0, 2 * Math.PI);
    else context.arc(...point, 5 * pixel, 0, 2 * Math.PI);
    if (part !== "place") {
      context.fillStyle = colours.paper;
      context.fill();
    }
    stroke(context, colours.accent, 2 * pixel);
  }
}

/** A cross in a ring where something is wrong. @param {Context} context @param {Editor} editor @param {Look} look */
function drawFindings(context, editor, { pixel, colours }) {
  for (const { scene, place, key } of editor.findings) {
    const at = place ?? placeOf(editor, key);
    if (scene !== editor.at || !at) continue;
    const arm = 6 * pixel;
    context.beginPath();
    context.arc(at[0], at[1], 14 * pixel, 0, 2 * Math.PI);
    for (const side of [1, -1]) {
      context.moveTo(at[0] - arm, at[1] - side * arm);
      context.lineTo(at[0] + arm, at[1] + side * arm);
    }
    stroke(context, colours.paper, 5 * pixel);
    stroke(context, colours.bad, 2.5 * pixel);
  }
}

/** @param {Editor} editor @param {string} key @returns {number[] | null} */
function placeOf(editor, key) {
  const thing = thingOf(key);
  return thing?.kind === "pedestrians" ? (editor.scene.pedestrians?.[thing.index]?.position ?? null) : null;
}
