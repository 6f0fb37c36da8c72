// What is drawn around the cells: the ground, the grid that points snap to, the map's edge, the axes of its frame, a
// scale bar.

import { inCells, toCells, toMetres } from "studio/map/frame.js";
import { roundStep } from "studio/edit/snap.js";

/**
 * @typedef {import("./frame.js").Frame} Frame
 * @typedef {import("../edit/view.js").View} View
 * @typedef {[number, number]} Point
 */

const LEAST = 9; // pixels between lines of the grid

/**
 * @param {() => {frame: Frame, tiles: import("./tiles.js").Tiles} | null} shown
 * @returns {import("../edit/view.js").Layer}
 */
export function ground(shown) {
  return {
    name: "ground",
    draw: (context, view) => {
      const open = shown();
      if (!open) return;
      const scale = view.camera.scale * view.ratio * open.frame.resolution;
      inCells(context, open.frame);
      open.tiles.draw(context, seenCells(view, open.frame), scale);
    },
  };
}

/** The cells that are seen. @param {View} view @param {Frame} frame */
function seenCells(view, frame) {
  const [left, right, bottom, top] = view.seen;
  const corners = [left, right].flatMap((x) => [bottom, top].map((y) => toCells(frame, [x, y])));
  const [columns, rows] = [0, 1].map((side) => corners.map((corner) => corner[side]));
  return {
    left: Math.floor(Math.min(...columns)),
    right: Math.ceil(Math.max(...columns)),
    top: Math.floor(Math.min(...rows)),
    bottom: Math.ceil(Math.max(...rows)),
  };
}

/**
 * The lines that points snap to, where they are not too close.
 * @param {() => Frame | null} frame
 * @param {() => number} step m
 * @param {() => string} colour
 * @returns {import("../edit/view.js").Layer}
 */
export function lattice(frame, step, colour) {
  return {
    name: "lattice",
    draw: (context, view) => {
      const map = frame();
      if (!map || !(step() > 0)) return;
      const cells = step() / map.resolution;
      const pixels = step() * view.camera.scale;
      const every = cells * Math.max(1, 10 ** Math.ceil(Math.log10(LEAST / pixels)));
      const seen = seenCells(view, map);
      const [left, right] = [Math.max(seen.left, 0), Math.min(seen.right, map.width)];
      const [top, bottom] = [Math.max(seen.top, 0), Math.min(seen.bottom, map.height)];
      inCells(context, map);
      context.beginPath();
      for (let column = every * Math.ceil(left / every); column <= right; column += every) {
        context.moveTo(column, top);
        context.lineTo(column, bottom);
      }
      for (let up = every * Math.ceil((map.height - bottom) / every); up <= map.height - top; up += every) {
        context.moveTo(left, map.height - up);
        context.lineTo(right, map.height - up);
      }
      context.globalAlpha = 0.22;
      context.lineWidth = view.pixel / map.resolution / view.ratio;
      context.strokeStyle = colour();
      context.stroke();
    },
  };
}

/**
 * The edge of the map, and x and y of its frame where they begin.
 * @param {() => Frame | null} frame
 * @param {() => {line: string, person: string, path: string}} colours
 * @returns {import("../edit/view.js").Layer}
 */
export function edges(frame, colours) {
  return {
    name: "edges",
    draw: (context, view) => {
      const map = frame();
      if (!map) return;
      const corners = /** @type {Point[]} */ ([
        [0, 0],
        [map.width, 0],
        [map.width, map.height],
        [0, map.height],
      ]);
      context.beginPath();
      for (const corner of corners) context.lineTo(...toMetres(map, corner));
      context.closePath();
      context.lineWidth = view.pixel;
      context.strokeStyle = colours().line;
      context.stroke();
      axis(context, view, [40 * view.pixel, 0], colours().person);
      axis(context, view, [0, 40 * view.pixel], colours().path);
    },
  };
}

/** @param {CanvasRenderingContext2D} context @param {View} view @param {Point} to @param {string} colour */
function axis(context, view, to, colour) {
  context.beginPath();
  context.moveTo(0, 0);
  context.lineTo(...to);
  context.lineWidth = 2.5 * view.pixel;
  context.strokeStyle = colour;
  context.stroke();
}

/**
 * A bar of a round length in the lower left corner.
 * @param {() => {ink: string, paper: string}} colours
 * @returns {import("../edit/view.js").Layer}
 */
export function scaleBar(colours) {
  return {
    name: "scale",
    draw: (context, view) => {
      const length = roundStep(60 * view.pixel);
      const width = length * view.camera.scale;
      const { ink, paper } = colours();
      context.setTransform(view.ratio, 0, 0, view.ratio, 12 * view.ratio, (view.pane.height - 14) * view.ratio);
      context.globalAlpha = 0.85;
      context.fillStyle = paper;
      context.fillRect(-6, -20, width + 12, 28);
      context.globalAlpha = 1;
      context.fillStyle = ink;
      context.fillRect(0, 0, width, 2);
      context.fillRect(0, -4, 2, 6);
      context.fillRect(width - 2, -4, 2, 6);
      context.font = "12px system-ui, sans-serif";
      context.textAlign = "center";
      context.fillText(length >= 1 ? `${length} m` : `${Math.round(length * 100)} cm`, width / 2, -6);
    },
  };
}
