// Draws where a running episode is: the map from above, robot, people and goal.

import { Camera } from "arena/camera.js";
import { faded, ground } from "arena/looks.js";

/** @typedef {{width: number, height: number, resolution: number, origin: number[], cells: string}} LiveMap */
/**
 * @typedef {{episode: number, scenario: string, stamp: number, time_limit: number, pose: number[], people: number[][],
 * goal: number[], radius: number, grid: string, contact: boolean}} Running
 */

/** The part of a map that is free, with a margin: left, right, bottom, top, m. @param {LiveMap} map */
export function windowOfMap(map) {
  let [left, right, bottom, top] = [map.width, 0, map.height, 0];
  for (let at = map.cells.indexOf("0"); at >= 0; at = map.cells.indexOf("0", at + 1)) {
    const [i, j] = [at % map.width, Math.floor(at / map.width)];
    [left, right, bottom, top] = [Math.min(left, i), Math.max(right, i + 1), Math.min(bottom, j), Math.max(top, j + 1)];
  }
  const [c, s] = [Math.cos(map.origin[2]), Math.sin(map.origin[2])];
  const corners = [left, right].flatMap((i) =>
    [bottom, top].map((j) => [
      map.origin[0] + map.resolution * (c * i - s * j),
      map.origin[1] + map.resolution * (s * i + c * j),
    ]),
  );
  const [xs, ys] = [corners.map(([x]) => x), corners.map(([, y]) => y)];
  return [Math.min(...xs) - 0.5, Math.max(...xs) + 0.5, Math.min(...ys) - 0.5, Math.max(...ys) + 0.5];
}

/** A map as a picture, one pixel a cell. @param {LiveMap} map @param {Element} element whose colours it has */
export function pictureOf(map, element) {
  const colours = ground(element);
  const bytes = [colours.free, colours.wall, colours.unknown].map((text) =>
    [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16)),
  );
  const picture = document.createElement("canvas");
  [picture.width, picture.height] = [map.width, map.height];
  const context = /** @type {CanvasRenderingContext2D} */ (picture.getContext("2d"));
  const image = context.createImageData(map.width, map.height);
  for (let i = 0; i < map.cells.length; i++) image.data.set([...bytes[Number(map.cells[i])], 255], 4 * i);
  context.putImageData(image, 0, 0);
  return picture;
}

/**
 * @param {HTMLCanvasElement} canvas @param {Running} running
 * @param {{map: LiveMap, picture: HTMLCanvasElement, window: number[]} | null} world null while it is fetched
 */
export function drawRunning(canvas, running, world) {
  const ratio = window.devicePixelRatio || 1;
  [canvas.width, canvas.height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const colours = ground(canvas);
  context.fillStyle = colours.unknown;
  context.fillRect(0, 0, canvas.width, canvas.height);
  const camera = new Camera();
  const [x, y, theta] = running.pose;
  camera.fit(world ? world.window : [x - 5, x + 5, y - 4, y + 4], canvas.clientWidth, canvas.clientHeight);
  camera.apply(context, { x: 0, y: 0, width: canvas.clientWidth, height: canvas.clientHeight }, ratio);
  if (world) {
    const { map, picture } = world;
    context.save();
    context.translate(map.origin[0], map.origin[1]);
    context.rotate(map.origin[2]);
    context.imageSmoothingEnabled = false;
    context.drawImage(picture, 0, 0, map.width * map.resolution, map.height * map.resolution);
    context.restore();
  }
  disc(context, running.goal[0], running.goal[1], 0.3, faded(colours.goal, 0.8));
  for (const [px, py, radius] of running.people) disc(context, px, py, radius, faded(colours.person, 0.85));
  const least = 5 / camera.scale; // m; a robot is never smaller than ten pixels
  disc(context, x, y, Math.max(running.radius, least), running.contact ? colours.bad : "#0072B2");
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(
    x + Math.max(running.radius, least) * Math.cos(theta),
    y + Math.max(running.radius, least) * Math.sin(theta),
  );
  context.strokeStyle = "#ffffff";
  context.lineWidth = 2 / camera.scale;
  context.stroke();
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {number} x
 * @param {number} y
 * @param {number} radius
 * @param {string} colour
 */
function disc(context, x, y, radius, colour) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fillStyle = colour;
  context.fill();
}
