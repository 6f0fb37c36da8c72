// The tools that draw on a map: brush, wall, rectangle, polygon, fill, and the length that tells the scale.

import { toAngle } from "studio/edit/snap.js";
import { snapped, toCells, toMetres } from "studio/map/frame.js";
import { flood, line, outline, polygon, rectangle, stroke, wall } from "studio/map/raster.js";

/**
 * @typedef {[number, number]} Point
 * @typedef {import("../edit/tools.js").Tool} Tool
 * @typedef {import("../edit/tools.js").Hand} Hand
 * @typedef {object} Pencil what tools draw with
 * @property {import("./kinds.js").Kind} kind
 * @property {number} width m
 * @property {boolean} filled
 * @property {number} step of the grid that points snap to, m; 0: none
 * @property {import("./kinds.js").Kind} beyond what cells are that a larger map has more
 *
 * @typedef {object} Desk
 * @property {() => import("./model.js").OpenMap | null} map
 * @property {Pencil} pencil
 * @property {() => string} colour of what is being drawn
 * @property {(metres: number, cells: number) => void} measured
 */

/** @param {Desk} desk @param {Hand} hand @param {Point | null} [from] @returns {Point} */
export function snap(desk, hand, from = null) {
  const map = desk.map();
  if (!map) return hand.point;
  const point = hand.shift && from ? toAngle(from, hand.point) : hand.point;
  return hand.alt ? point : snapped(map.frame, point, desk.pencil.step);
}

/**
 * A brush of a kind; null: the kind of the pencil.
 * @param {Desk} desk
 * @param {Pick<Tool, "name" | "title" | "key">} facts
 * @param {import("./kinds.js").Kind | null} kind
 * @returns {Tool}
 */
export function brush(desk, facts, kind) {
  /** @type {Point | null} */ let last = null;
  /** @type {Point | null} */ let over = null;
  const paint = (/** @type {Point} */ from, /** @type {Point} */ to) => {
    const map = desk.map();
    const code = map?.code(kind ?? desk.pencil.kind) ?? null;
    if (!map || code === null) return;
    const radius = desk.pencil.width / map.frame.resolution / 2;
    stroke(toCells(map.frame, from), toCells(map.frame, to), radius, (row, left, right) =>
      map.grid.run(row, left, right, code),
    );
    map.grid.tell();
  };
  return {
    ...facts,
    cursor: "crosshair",
    down: ({ point }) => {
      desk.map()?.grid.begin();
      paint(point, point);
      last = over = point;
    },
    move: ({ point }) => {
      if (last) paint(last, point);
      last = over = point;
    },
    hover: ({ point }) => void (over = point),
    up: () => {
      if (last) desk.map()?.endStroke(facts.name);
      last = null;
    },
    cancel: () => {
      if (last) desk.map()?.grid.cancel();
      last = over = null;
    },
    draw: (context, view) => over && ring(context, over, desk.pencil.width / 2, view, desk.colour()),
  };
}

/**
 * Walls from point to point: drag one, or click several; Enter, Escape or a double click ends them.
 * @param {Desk} desk
 * @param {Pick<Tool, "name" | "title" | "key">} facts
 * @param {boolean} thin one cell
 * @returns {Tool}
 */
export function walls(desk, facts, thin) {
  /** @type {Point | null} */ let from = null;
  /** @type {Point | null} */ let to = null;
  let dragged = false;
  const build = () => {
    const map = desk.map();
    if (!map || !from || !to || (from[0] === to[0] && from[1] === to[1])) return;
    const [a, b] = [toCells(map.frame, from), toCells(map.frame, to)];
    const width = desk.pencil.width / map.frame.resolution;
    map.stroke(facts.name, desk.pencil.kind, (fill) => (thin ? line(a, b, fill) : wall(a, b, width, fill)));
  };
  const stop = () => void (from = to = null);
  return {
    ...facts,
    cursor: "crosshair",
    down: (hand) => {
      if (hand.double) return stop();
      const point = snap(desk, hand, from);
      if (from) {
        to = point;
        build();
      }
      [from, to, dragged] = [point, point, false];
    },
    move: (hand) => {
      to = snap(desk, hand, from);
      dragged ||= !!from && Math.hypot(to[0] - from[0], to[1] - from[1]) > 0;
    },
    hover: (hand) => void (to = snap(desk, hand, from)),
    up: () => {
      if (!dragged) return;
      build();
      stop();
    },
    cancel: stop,
    press: (event) => event.key === "Escape" && from !== null && (stop(), true),
    draw: (context, view) => {
      if (to && !from) ring(context, to, 4 * view.pixel, view, desk.colour());
      if (from && to)
        path(
          context,
          [from, to],
          false,
          thin ? 2 * view.pixel : Math.max(desk.pencil.width, 2 * view.pixel),
          desk.colour(),
        );
    },
  };
}

/** A rectangle along the cells, from corner to corner. @param {Desk} desk @returns {Tool} */
export function box(desk) {
  /** @type {Point | null} */ let from = null;
  /** @type {Point | null} */ let to = null;
  const around = () => {
    const map = desk.map();
    if (!map || !from || !to) return [];
    const [[a, b], [c, d]] = [toCells(map.frame, from), toCells(map.frame, to)];
    return /** @type {Point[]} */ ([
      [a, b],
      [c, b],
      [c, d],
      [a, d],
    ]);
  };
  return {
    name: "rectangle",
    title: "A rectangle, filled or as walls",
    key: "r",
    cursor: "crosshair",
    down: (hand) => void (from = to = snap(desk, hand)),
    move: (hand) => void (to = snap(desk, hand)),
    up: () => {
      const [map, cells] = [desk.map(), around()];
      [from, to] = [null, null];
      if (!map || !cells.length) return;
      const width = desk.pencil.width / map.frame.resolution;
      map.stroke("rectangle", desk.pencil.kind, (fill) =>
        desk.pencil.filled ? rectangle(cells[0], cells[2], fill) : outline(cells, width, fill),
      );
    },
    cancel: () => void (from = to = null),
    draw: (context, view) => {
      const map = desk.map();
      if (map && from)
        path(
          context,
          around().map((cell) => toMetres(map.frame, cell)),
          true,
          2 * view.pixel,
          desk.colour(),
        );
    },
  };
}

/**
 * A polygon, corner by corner; a double click, Enter or a click on the first corner closes it.
 * @param {Desk} desk
 * @returns {Tool}
 */
export function corners(desk) {
  /** @type {Point[]} */ let points = [];
  /** @type {Point | null} */ let over = null;
  const close = () => {
    const map = desk.map();
    const cells = map ? points.map((point) => toCells(map.frame, point)) : [];
    points = [];
    if (!map || cells.length < 3) return;
    const width = desk.pencil.width / map.frame.resolution;
    map.stroke("polygon", desk.pencil.kind, (fill) =>
      desk.pencil.filled ? polygon(cells, fill) : outline(cells, width, fill),
    );
  };
  let reach = 0; // m around the first corner in which a click closes
  return {
    name: "polygon",
    title: "A polygon, filled or as walls: click its corners, the first one again to close it",
    key: "p",
    cursor: "crosshair",
    down: (hand) => {
      const point = snap(desk, hand, points.at(-1) ?? null);
      const home = points.length > 2 && Math.hypot(point[0] - points[0][0], point[1] - points[0][1]) <= reach;
      if (hand.double || home) close();
      else points.push(point);
    },
    move: (hand) => void (over = snap(desk, hand, points.at(-1) ?? null)),
    hover: (hand) => void (over = snap(desk, hand, points.at(-1) ?? null)),
    cancel: () => void (points = []),
    press: (event) => {
      if (!points.length || !["Escape", "Backspace", "c"].includes(event.key)) return false;
      if (event.key === "c") close();
      else if (event.key === "Escape") points = [];
      else points.pop();
      return true;
    },
    draw: (context, view) => {
      reach = 10 * view.pixel;
      if (points.length) path(context, over ? [...points, over] : points, false, 2 * view.pixel, desk.colour());
      if (points.length) ring(context, points[0], 5 * view.pixel, view, desk.colour());
      else if (over) ring(context, over, 4 * view.pixel, view, desk.colour());
    },
  };
}

/** Fill what hangs together and is of one kind. @param {Desk} desk @returns {Tool} */
export function bucket(desk) {
  return {
    name: "fill",
    title: "Fill an area of one kind",
    key: "f",
    cursor: "crosshair",
    down: ({ point }) => {
      const map = desk.map();
      if (!map) return;
      const [column, row] = toCells(map.frame, point).map(Math.floor);
      map.stroke("fill", desk.pencil.kind, (fill) => flood(map.grid, map.kinds, column, row, fill));
    },
  };
}

/** A length on the map; what it really is gives the scale. @param {Desk} desk @returns {Tool} */
export function ruler(desk) {
  /** @type {Point | null} */ let from = null;
  /** @type {Point | null} */ let to = null;
  let held = false;
  const tell = () => {
    const map = desk.map();
    const length = from && to ? Math.hypot(to[0] - from[0], to[1] - from[1]) : 0;
    if (map && length) desk.measured(length, length / map.frame.resolution);
  };
  return {
    name: "ruler",
    title: "Measure a length, or set the scale by one that is known",
    key: "m",
    cursor: "crosshair",
    down: (hand) => {
      from = to = snap(desk, hand);
      held = true;
    },
    move: (hand) => {
      if (held) to = snap(desk, hand, from);
      tell();
    },
    up: () => void (held = false),
    cancel: () => {
      from = to = null;
      held = false;
    },
    draw: (context, view) => {
      if (!from || !to) return;
      path(context, [from, to], false, 2 * view.pixel, desk.colour());
      for (const end of [from, to]) ring(context, end, 4 * view.pixel, view, desk.colour());
    },
  };
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Point[]} points
 * @param {boolean} closed
 * @param {number} width m
 * @param {string} colour
 */
export function path(context, points, closed, width, colour) {
  context.beginPath();
  for (const [x, y] of points) context.lineTo(x, y);
  if (closed) context.closePath();
  context.globalAlpha = 0.75;
  context.lineWidth = width;
  context.strokeStyle = colour;
  context.stroke();
  context.globalAlpha = 1;
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Point} centre
 * @param {number} radius m
 * @param {import("../edit/view.js").View} view
 * @param {string} colour
 */
function ring(context, [x, y], radius, view, colour) {
  context.beginPath();
  context.arc(x, y, Math.max(radius, 2 * view.pixel), 0, 2 * Math.PI);
  context.lineWidth = 1.5 * view.pixel;
  context.strokeStyle = colour;
  context.stroke();
}
