// One pane's solid world: what stands, and what moves in the episodes that it shows.

import { windowOf } from "arena/camera.js";
import { DOOR, ROBOTS, ofMate } from "arena/looks.js";
import { WALL, bareFloor, building, goalOf, standing, upright } from "arena/solid/building.js";
import { Eye } from "arena/solid/eye.js";
import { Figure, walkOf } from "arena/solid/figures.js";
import { Beams, Touches, Trail, Way, nameOf } from "arena/solid/lines.js";
import { machineOf } from "arena/solid/machines.js";

/** @typedef {import("../episode.js").Episode} Episode */

/** What of one episode moves. */
class Drive {
  /** @param {any} three @param {Episode} episode @param {number} number @param {any} colours */
  constructor(three, episode, number, colours) {
    this.episode = episode;
    this.colours = colours;
    this.colour = ROBOTS[number % ROBOTS.length];
    this.group = new three.Group();
    this.machine = machineOf(three, episode.said.robot, this.colour);
    this.team = Array.from({ length: episode.arrays.team?.shape[0] ?? 0 }, () =>
      machineOf(three, episode.said.robot, colours.soft),
    );
    this.people = Array.from({ length: episode.count }, (_, person) => {
      const { values, rows } = episode.arrays.people;
      const place = (/** @type {number} */ row) => [
        values[person * 2 * rows + row],
        values[(person * 2 + 1) * rows + row],
      ];
      const figure = new Figure(three, person, episode.arrays.radii.values[person]);
      return { figure, walk: walkOf(episode.stamps, place) };
    });
    this.rolled = rolled(episode);
    this.path = new Way(three, colours.path, 0.016, true);
    this.wayOut = new Way(three, colours.way, 0.02, true);
    this.trail = new Trail(three, episode, this.colour);
    this.touches = new Touches(three, colours.bad);
    const { lidar } = episode.said.robot;
    this.beams =
      lidar && (episode.map || episode.arrays.scan) ? new Beams(three, lidar, this.machine.lidar, colours.beam) : null;
    this.name = nameOf(three, String(episode.name), this.colour);
    this.group.add(
      this.machine.group,
      ...this.team.map(({ group }) => group),
      ...this.people.map(({ figure }) => figure.group),
    );
    this.group.add(this.path.line, this.wayOut.line, this.trail.line, this.touches.group, this.name);
    if (this.beams) this.group.add(this.beams.group);
  }

  /** @param {number} time @param {import("../scene.js").Layers} layers @param {boolean} named */
  draw(time, layers, named) {
    const { episode, machine } = this;
    const moment = episode.at(Math.min(time, episode.end));
    const [x, y, theta] = moment.pose;
    machine.group.position.set(x, y, 0);
    machine.group.rotation.z = theta;
    for (const { mesh, radius } of machine.wheels) mesh.rotation.y = (this.rolled[moment.row] / radius) % (2 * Math.PI);
    for (const accent of machine.accents) accent.color.set(moment.touching ? this.colours.bad : this.colour);
    this.team.forEach(({ group, accents }, mate) => {
      for (const accent of accents) accent.color.set(named ? this.colours.soft : ofMate(mate));
      group.position.set(moment.team[mate][0], moment.team[mate][1], 0);
      group.rotation.z = moment.team[mate][2];
    });
    this.#people(moment, layers.people, time);
    this.path.draw(layers.path ? moment.path : []);
    this.wayOut.draw(layers.way_out ? episode.wayOut(time) : []);
    this.trail.line.visible = layers.trail;
    this.trail.draw(moment.row);
    this.touches.draw(episode, Math.min(time, episode.end));
    this.name.visible = named;
    this.name.position.set(x, y, machine.lidar + 0.45);
    if (!this.beams) return;
    this.beams.group.visible = layers.lidar;
    if (layers.lidar) this.beams.draw(episode, moment);
  }

  /** @param {import("../episode.js").Moment} moment @param {boolean} shown @param {number} time */
  #people(moment, shown, time) {
    const { row } = moment;
    const next = Math.min(row + 1, this.episode.rows - 1);
    const span = this.episode.stamps[next] - this.episode.stamps[row];
    const share = span > 0 ? Math.min(1, Math.max(0, (time - this.episode.stamps[row]) / span)) : 0;
    for (const { figure } of this.people) figure.group.visible = false;
    if (!shown) return;
    for (const { number, x, y, state } of moment.people) {
      const { figure, walk } = this.people[number];
      const mix = (/** @type {Float32Array} */ of) => of[row] + share * (of[next] - of[row]);
      figure.group.visible = true;
      figure.pose([x, y], mix(walk.facing), mix(walk.steps), mix(walk.stride), state, this.colours);
    }
  }
}

/** How far a robot has rolled forwards at each row, m. @param {Episode} episode */
function rolled(episode) {
  const found = new Float32Array(episode.rows);
  for (let row = 1; row < episode.rows; row++)
    found[row] = found[row - 1] + episode.value("twist", row - 1) * (episode.stamps[row] - episode.stamps[row - 1]);
  return found;
}

export class World {
  /**
   * @param {any} three @param {{number: number, episode: Episode}[]} shown @param {any} colours
   * @param {number} shadows pixels of the side of their map, at most
   */
  constructor(three, shown, colours, shadows) {
    const first = shown[0].episode;
    const window = windowOf(first);
    this.scene = new three.Scene();
    this.scene.background = new three.Color(colours.sky);
    this.eye = new Eye(three, window);
    this.drives = shown.map(({ number, episode }) => new Drive(three, episode, number, colours));
    this.scene.add(first.map ? building(three, first.map, colours) : bareFloor(three, window, colours));
    for (const obstacle of first.said.obstacles) this.scene.add(standing(three, obstacle, colours));
    /** @type {any[]} */ this.doors = (first.said.doors ?? []).map((/** @type {number[][]} */ points) =>
      upright(three, points, 0.95 * WALL, DOOR),
    );
    if (this.doors.length) this.scene.add(...this.doors);
    this.scene.add(goalOf(three, first.said, colours), ...this.drives.map((drive) => drive.group));
    light(three, this.scene, window, shadows);
  }

  /** @param {number} time @param {import("../scene.js").Layers} layers @param {number} aspect */
  draw(time, layers, aspect) {
    for (const drive of this.drives) drive.draw(time, layers, this.drives.length > 1);
    const [first] = this.drives;
    // an open door has sunk into the floor, but for its upper edge
    for (const [index, door] of this.doors.entries())
      door.scale.z = first.episode.doorOpen(index, Math.min(time, first.episode.end)) ? 0.02 : 1;
    this.eye.place(aspect, first.episode, time, first.machine.lidar);
  }
}

/**
 * A sky, and a sun that throws shadows over the whole window.
 * @param {any} three @param {any} scene @param {number[]} window @param {number} shadows pixels of a side, at most
 */
function light(three, scene, window, shadows) {
  const [left, right, bottom, top] = window;
  const [x, y, reach] = [(left + right) / 2, (bottom + top) / 2, Math.hypot(right - left, top - bottom) / 2];
  scene.add(new three.HemisphereLight("#ffffff", "#9aa3ad", 1.7));
  const sun = new three.DirectionalLight("#fff6e5", 1.9);
  sun.position.set(x - 0.45 * reach - 3, y - 0.3 * reach - 3, 1.2 * reach + 6);
  sun.target.position.set(x, y, 0);
  sun.castShadow = true;
  const side = Math.min(shadows, 2 ** Math.ceil(Math.log2(Math.max(256, 60 * reach))));
  sun.shadow.mapSize.set(side, side);
  Object.assign(sun.shadow.camera, {
    left: -reach,
    right: reach,
    top: reach,
    bottom: -reach,
    near: 0.5,
    far: 4 * reach + 20,
  });
  sun.shadow.bias = -0.0006;
  sun.shadow.normalBias = 0.005;
  scene.add(sun, sun.target);
}
