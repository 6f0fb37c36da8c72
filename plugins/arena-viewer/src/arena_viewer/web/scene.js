// Draws episodes at a moment on a canvas: map, obstacles, path, trail, beams, people, robots, contacts.

import { drawFloor, pictureOf } from "arena/floor.js";
import { rangesOf } from "arena/lidar.js";
import { DOOR, ROBOTS, faded, ground, ofMate } from "arena/looks.js";
import { drawPeople } from "arena/people.js";
import { drawConsidered, drawTracks } from "arena/thoughts.js";

/** @typedef {import("./episode.js").Episode} Episode */
/**
 * @typedef {{x: number, y: number, width: number, height: number, shown: number[]}} Pane  numbers of the episodes that
 * it shows
 */
/**
 * @typedef {{path: boolean, trail: boolean, lidar: boolean, people: boolean, estimate: boolean, tracks: boolean,
 * considered: boolean, way_out?: boolean}} Layers
 */

export class Scene {
  /** @param {HTMLCanvasElement} canvas @param {Episode[]} episodes */
  constructor(canvas, episodes) {
    this.canvas = canvas;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    this.episodes = episodes;
    this.colours = ground(canvas);
    this.scale = 1; // pixels a metre
    /** @type {Map<any, HTMLCanvasElement>} */ this.maps = new Map();
  }

  /** Read the colours again, after the page went dark or light. */
  recolour() {
    this.colours = ground(this.canvas);
    this.maps.clear();
  }

  /**
   * @param {Pane[]} panes @param {import("./camera.js").Camera} camera @param {number} time
   * @param {Layers} layers @param {number} ratio device pixels a CSS pixel
   */
  draw(panes, camera, time, layers, ratio) {
    const { context } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = this.colours.unknown;
    context.fillRect(0, 0, this.canvas.width, this.canvas.height);
    for (const pane of panes) {
      context.save();
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.beginPath();
      context.rect(ratio * pane.x, ratio * pane.y, ratio * pane.width, ratio * pane.height);
      context.clip();
      camera.apply(context, pane, ratio);
      this.#pane(pane, camera, time, layers);
      context.restore();
    }
  }

  /** @param {Pane} pane @param {import("./camera.js").Camera} camera @param {number} time @param {Layers} layers */
  #pane(pane, camera, time, layers) {
    const first = this.episodes[pane.shown[0]];
    if (first.map) this.#map(first.map);
    for (const obstacle of first.said.obstacles) this.#obstacle(obstacle);
    for (const [index, door] of (first.said.doors ?? []).entries())
      this.#door(door, first.doorOpen(index, Math.min(time, first.end)), 1.5 / camera.scale);
    this.moving(pane.shown, camera.scale, time, layers);
  }

  /**
   * Draw what belongs to episodes at a moment over a map that is drawn already, in a context of metres: goal, ways,
   * beams, people, robots.
   * @param {number[]} numbers of the episodes
   * @param {number} scale pixels a metre
   * @param {number} time
   * @param {Layers} layers
   */
  moving(numbers, scale, time, layers) {
    const shown = numbers.map((number) => ({ number, episode: this.episodes[number] }));
    this.scale = scale;
    const thin = 1 / scale; // m of a pixel
    this.#goal(shown[0].episode, thin);
    const moments = shown.map(({ number, episode }) => ({
      number,
      episode,
      moment: episode.at(Math.min(time, episode.end)),
    }));
    for (const { number, episode, moment } of moments) {
      const colour = ROBOTS[number % ROBOTS.length];
      if (layers.path) this.#line(moment.path, this.colours.path, 1.5 * thin, [6 * thin, 4 * thin]);
      if (layers.trail && moments.length === 1) this.#teamTrails(episode, moment, thin);
      if (layers.trail) this.#trail(episode, moment, colour, 2 * thin);
      if (layers.way_out) this.#line(episode.wayOut(time), this.colours.way, 2.5 * thin, [8 * thin, 5 * thin]);
    }
    // people of several planners differ as soon as they react: they are drawn faintly when overlaid
    for (const { episode, moment, number } of moments) {
      if (layers.lidar) this.#beams(episode, moment, thin);
      if (layers.people) drawPeople(this.context, moment.people, this.colours, thin, moments.length > 1 ? 0.45 : 0.9);
      if (layers.tracks) drawTracks(this.context, episode.tracks(moment.row), this.colours.ink, thin);
      if (layers.estimate) this.#robot(episode, moment.estimate, "", 1.5 * thin, ROBOTS[number % ROBOTS.length]);
    }
    for (const { number, episode, moment } of moments) {
      const colour = ROBOTS[number % ROBOTS.length];
      if (layers.considered)
        drawConsidered(this.context, episode.considered(moment.row), colour, this.colours.bad, thin);
      moment.team.forEach((mate, index) => {
        const own = moments.length === 1 ? ofMate(index) : this.colours.soft;
        this.#robot(episode, mate, own, 1.5 * thin, this.colours.paper);
      });
      this.#robot(episode, moment.pose, moment.touching ? this.colours.bad : colour, 1.5 * thin, this.colours.paper);
      this.#contacts(episode, time, thin);
    }
  }

  /** @param {any} map */
  #map(map) {
    const [height, width] = map.cells.shape;
    let picture = this.maps.get(map);
    if (!picture) {
      picture = pictureOf(map.cells.values, width, height, [
        this.colours.free,
        this.colours.wall,
        this.colours.unknown,
      ]);
      this.maps.set(map, picture);
    }
    drawFloor(this.context, map, picture);
  }

  /** @param {any} obstacle */
  #obstacle(obstacle) {
    const { context } = this;
    const points = /** @type {number[][]} */ (obstacle.vertices_xy);
    context.beginPath();
    if (points.length < 3) context.arc(points[0][0], points[0][1], obstacle.radius, 0, 2 * Math.PI);
    else points.forEach(([x, y]) => context.lineTo(x, y));
    context.fillStyle = this.colours.wall;
    context.fill();
  }

  /** A door: filled while it is closed. @param {number[][]} points @param {boolean} open @param {number} width */
  #door(points, open, width) {
    const { context } = this;
    context.beginPath();
    points.forEach(([x, y]) => context.lineTo(x, y));
    context.closePath();
    context.fillStyle = context.strokeStyle = DOOR;
    if (!open) context.fill();
    context.lineWidth = width;
    context.stroke();
  }

  /** @param {Episode} episode @param {number} thin */
  #goal(episode, thin) {
    const { context, colours } = this;
    const [x, y] = episode.said.goal;
    context.beginPath();
    context.arc(x, y, episode.said.goal_radius, 0, 2 * Math.PI);
    context.fillStyle = faded(colours.goal, 0.55);
    context.fill();
    context.lineWidth = thin;
    context.strokeStyle = colours.soft;
    context.stroke();
    context.beginPath();
    context.arc(episode.said.start[0], episode.said.start[1], 4 * thin, 0, 2 * Math.PI);
    context.stroke();
  }

  /** @param {number[][]} points @param {string} colour @param {number} width @param {number[]} dashes */
  #line(points, colour, width, dashes = []) {
    const { context } = this;
    context.beginPath();
    for (const [x, y] of points) context.lineTo(x, y);
    context.setLineDash(dashes);
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke();
    context.setLineDash([]);
  }

  /**
   * @param {Episode} episode
   * @param {import("./episode.js").Moment} moment
   * @param {string} colour
   * @param {number} width
   */
  #trail(episode, moment, colour, width) {
    const { values, rows } = episode.arrays.pose;
    const points = [];
    for (let row = 0; row <= moment.row; row++) points.push([values[row], values[rows + row]]);
    this.#line([...points, moment.pose], colour, width);
  }

  /**
   * The ways of teammates, each in a colour of its own.
   * @param {Episode} episode
   * @param {import("./episode.js").Moment} moment
   * @param {number} width
   */
  #teamTrails(episode, moment, width) {
    moment.team.forEach((mate, index) => {
      const { values, rows } = episode.arrays.team;
      const points = [];
      for (let row = 0; row <= moment.row; row++)
        points.push([values[index * 3 * rows + row], values[(index * 3 + 1) * rows + row]]);
      this.#line([...points, mate], ofMate(index), width);
    });
  }

  /** @param {Episode} episode @param {import("./episode.js").Moment} moment @param {number} thin */
  #beams(episode, moment, thin) {
    const { lidar } = episode.said.robot;
    if (!lidar) return;
    const { context } = this;
    const ranges = rangesOf(episode, moment);
    const [x, y, theta] = moment.pose;
    const from = [
      x + Math.cos(theta) * lidar.mount.x - Math.sin(theta) * lidar.mount.y,
      y + Math.sin(theta) * lidar.mount.x + Math.cos(theta) * lidar.mount.y,
    ];
    context.fillStyle = this.colours.beam;
    const side = 2.2 * thin;
    for (let beam = 0; beam < ranges.length; beam++) {
      if (!Number.isFinite(ranges[beam])) continue;
      const angle = theta + lidar.mount.theta + lidar.angle_min + beam * lidar.angle_increment;
      context.fillRect(
        from[0] + ranges[beam] * Math.cos(angle) - side / 2,
        from[1] + ranges[beam] * Math.sin(angle) - side / 2,
        side,
        side,
      );
    }
  }

  /**
   * @param {Episode} episode
   * @param {number[]} pose
   * @param {string} fill empty: the outline alone
   * @param {number} width
   * @param {string} line
   */
  #robot(episode, pose, fill, width, line) {
    const { context } = this;
    const { vertices_xy: vertices, radius } = episode.said.robot.footprint;
    context.save();
    context.translate(pose[0], pose[1]);
    context.rotate(pose[2]);
    context.beginPath();
    if (vertices.length) for (const [x, y] of vertices) context.lineTo(x, y);
    else context.arc(0, 0, radius, 0, 2 * Math.PI);
    context.closePath();
    if (fill) {
      context.fillStyle = fill;
      context.fill();
    }
    context.strokeStyle = line;
    context.lineWidth = width;
    context.stroke();
    context.beginPath();
    context.moveTo(0, 0);
    context.lineTo(radius, 0);
    context.stroke();
    context.restore();
    const pixel = 1 / this.scale;
    if (!fill || radius > 6 * pixel) return;
    context.beginPath(); // too small to be seen: a ring around it
    context.arc(pose[0], pose[1], 8 * pixel, 0, 2 * Math.PI);
    context.strokeStyle = fill;
    context.lineWidth = 2 * pixel;
    context.stroke();
  }

  /**
   * Rings where the robot touched something in the last two seconds, and what that was.
   * @param {Episode} episode
   * @param {number} time
   * @param {number} thin
   */
  #contacts(episode, time, thin) {
    const { context } = this;
    for (const { stamp, x, y, kind } of episode.contacts) {
      const ago = time - stamp;
      if (ago < 0 || ago > 2) continue;
      context.beginPath();
      context.arc(x, y, 0.35 + 0.25 * ago, 0, 2 * Math.PI);
      context.strokeStyle = faded(this.colours.bad, 1 - ago / 2);
      context.lineWidth = 3 * thin;
      context.stroke();
      context.save();
      context.translate(x, y + 0.4 + 0.25 * ago);
      context.scale(thin, -thin); // text stands upright, in pixels
      context.font = "600 13px system-ui, sans-serif";
      context.textAlign = "center";
      context.fillStyle = faded(this.colours.bad, 1 - ago / 2);
      context.fillText(kind, 0, -3);
      context.restore();
    }
  }
}
