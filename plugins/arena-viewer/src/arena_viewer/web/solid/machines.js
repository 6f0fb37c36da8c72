// Robots of primitives, by name; any other is its footprint with a nose. Measures in m, of makers' data sheets:
// TurtleBot3 Burger (ROBOTIS e-manual: 138 x 178 x 192 mm, wheels 66 x 18 mm), Jackal (Clearpath: 508 x 430 x 250 mm,
// wheels of 98 mm radius, wheelbase 262 mm), Robotino 3 (Festo: 450 mm across, 290 mm high).

const BLACK = "#23262b";
const GREY = "#8b929b";

/**
 * @typedef {object} Machine
 * @property {any} group its front is x
 * @property {{mesh: any, radius: number}[]} wheels that roll
 * @property {number} lidar height of the beams, m
 * @property {any[]} accents materials in the robot's own colour
 */

/** Makes one robot; parts are added to ``group``. */
class Maker {
  /** @param {any} three @param {string} colour */
  constructor(three, colour) {
    this.three = three;
    this.group = new three.Group();
    /** @type {{mesh: any, radius: number}[]} */ this.wheels = [];
    this.accent = new three.MeshLambertMaterial({ color: colour });
    this.black = new three.MeshLambertMaterial({ color: BLACK });
    this.grey = new three.MeshLambertMaterial({ color: GREY });
  }

  /** @param {any} geometry @param {any} material @param {number[]} at x, y, z of its middle */
  add(geometry, material, at) {
    const mesh = new this.three.Mesh(geometry, material);
    mesh.position.set(at[0], at[1], at[2]);
    mesh.castShadow = mesh.receiveShadow = true;
    this.group.add(mesh);
    return mesh;
  }

  /** @type {(size: number[], material: any, at: number[]) => any} */
  box(size, material, at) {
    return this.add(new this.three.BoxGeometry(size[0], size[1], size[2]), material, at);
  }

  /** An upright cylinder. @type {(radius: number, height: number, of: any, at: number[], sides?: number) => any} */
  can(radius, height, material, at, sides = 32) {
    return this.add(new this.three.CylinderGeometry(radius, radius, height, sides).rotateX(Math.PI / 2), material, at);
  }

  /** A wheel with a hub, which rolls. @type {(radius: number, width: number, at: number[]) => void} */
  wheel(radius, width, at) {
    const mesh = this.add(new this.three.CylinderGeometry(radius, radius, width, 24), this.black, at);
    const hub = new this.three.Mesh(new this.three.BoxGeometry(1.3 * radius, width + 0.004, 0.3 * radius), this.grey);
    mesh.add(hub);
    this.wheels.push({ mesh, radius });
  }

  /** @param {number} lidar m @returns {Machine} */
  made(lidar) {
    return { group: this.group, wheels: this.wheels, lidar, accents: [this.accent] };
  }
}

/** @param {Maker} maker */
function turtlebot(maker) {
  const axle = -0.032; // the axle is the origin of base_link; the body lies behind it
  for (const side of [1, -1]) maker.wheel(0.033, 0.018, [0, 0.08 * side, 0.033]);
  for (const z of [0.03, 0.078, 0.126]) maker.can(0.0745, 0.006, maker.black, [axle, 0, z], 8);
  for (const [x, y] of [
    [0.045, 0.045],
    [0.045, -0.045],
    [-0.045, 0.045],
    [-0.045, -0.045],
  ])
    maker.can(0.005, 0.13, maker.grey, [axle + x, y, 0.08], 8);
  maker.box([0.085, 0.06, 0.035], maker.accent, [axle, 0, 0.052]);
  maker.box([0.09, 0.055, 0.012], maker.accent, [axle, 0, 0.09]);
  maker.can(0.035, 0.03, maker.black, [axle, 0, 0.15]);
  maker.can(0.027, 0.024, maker.grey, [axle, 0, 0.178]);
  maker.add(new maker.three.SphereGeometry(0.012, 12, 8), maker.grey, [-0.09, 0, 0.012]);
  return maker.made(0.18);
}

/** @param {Maker} maker */
function jackal(maker) {
  for (const x of [0.131, -0.131]) for (const side of [1, -1]) maker.wheel(0.098, 0.05, [x, 0.178 * side, 0.098]);
  maker.box([0.42, 0.29, 0.13], maker.black, [0, 0, 0.135]);
  maker.box([0.46, 0.31, 0.018], maker.accent, [0, 0, 0.208]);
  for (const side of [1, -1]) maker.box([0.4, 0.05, 0.018], maker.accent, [0, 0.178 * side, 0.208]);
  for (const end of [1, -1]) maker.box([0.02, 0.3, 0.07], maker.accent, [0.225 * end, 0, 0.15]);
  maker.box([0.14, 0.14, 0.035], maker.grey, [0.1, 0, 0.235]);
  maker.can(0.045, 0.07, maker.black, [0.12, 0, 0.288]);
  for (const side of [1, -1]) maker.box([0.012, 0.05, 0.03], maker.grey, [0.236, 0.09 * side, 0.15]); // lamps
  return maker.made(0.29);
}

/** @param {Maker} maker */
function robotino(maker) {
  const white = new maker.three.MeshLambertMaterial({ color: "#e3e6ea" });
  maker.can(0.225, 0.05, maker.black, [0, 0, 0.055], 48);
  maker.can(0.21, 0.11, white, [0, 0, 0.135], 48);
  maker.can(0.225, 0.03, maker.accent, [0, 0, 0.2], 48);
  for (const angle of [Math.PI / 3, Math.PI, -Math.PI / 3]) {
    const wheel = maker.can(0.04, 0.036, maker.grey, [0.17 * Math.cos(angle), 0.17 * Math.sin(angle), 0.04], 20);
    wheel.geometry.rotateX(Math.PI / 2);
    wheel.rotation.z = angle - Math.PI / 2;
  }
  maker.box([0.2, 0.24, 0.09], maker.black, [-0.07, 0, 0.26]);
  maker.can(0.04, 0.06, maker.black, [0.12, 0, 0.245]);
  maker.box([0.02, 0.06, 0.03], maker.accent, [0.222, 0, 0.13]); // the camera shows where the front is
  return maker.made(0.25);
}

/** What is known of a robot alone: its footprint. @param {Maker} maker @param {any} footprint */
function unknown(maker, footprint) {
  const { three } = maker;
  const points = /** @type {number[][]} */ (footprint.vertices_xy ?? []);
  const { radius } = footprint;
  const tall = Math.min(1.2, Math.max(0.15, 0.9 * radius));
  if (points.length) {
    const shape = new three.Shape(points.map(([x, y]) => new three.Vector2(x, y)));
    const cut = { depth: tall - 0.03, bevelEnabled: false };
    maker.add(new three.ExtrudeGeometry(shape, cut), maker.accent, [0, 0, 0.03]);
  } else maker.can(radius, tall - 0.03, maker.accent, [0, 0, 0.03 + (tall - 0.03) / 2], 40);
  const reach = points.length ? Math.max(...points.map(([x]) => x)) : radius;
  const nose = new three.ConeGeometry(0.16 * radius, 0.45 * radius, 3).rotateZ(-Math.PI / 2);
  maker.add(nose, maker.black, [reach - 0.3 * radius, 0, tall + 0.01]);
  maker.can(0.2 * radius, 0.12 * radius, maker.black, [0, 0, tall + 0.06 * radius]);
  return maker.made(tall + 0.06 * radius);
}

/** Return a robot of the record. @param {any} three @param {any} robot @param {string} colour @returns {Machine} */
export function machineOf(three, robot, colour) {
  const maker = new Maker(three, colour);
  const name = String(robot.name);
  if (name.startsWith("turtlebot3")) return turtlebot(maker);
  if (name.startsWith("jackal")) return jackal(maker);
  if (name.startsWith("robotino")) return robotino(maker);
  return unknown(maker, robot.footprint);
}
