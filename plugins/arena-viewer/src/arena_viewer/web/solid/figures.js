// People as walking figures: legs and arms swing by the way that is covered, as their steps are long.

import { ofState } from "arena/looks.js";
import { turned } from "arena/episode.js";

const WALK_RATIO = 0.006; // m min, length of a step by steps a minute (Sekiya and Nagasaki 1998)
const SLOWEST = 0.08; // m/s below which a person turns nowhere and stands
const TURN = 0.35; // s in which a body turns into a new direction
// clothes above, below, hair and skin: several, by a person's number
const TOPS = ["#3f6fb5", "#b5523f", "#4f8f5b", "#8a5fa8", "#c9963a", "#3b8c93", "#a84f74", "#6b7280"];
const TROUSERS = ["#2b3242", "#4a4038", "#3a4a5c", "#5c5f66", "#263d33"];
const HAIR = ["#2a1f18", "#5b3a1e", "#8a6a3b", "#1b1b1f", "#777777"];
const SKIN = ["#f0c8a4", "#d9a071", "#a8703f", "#7a4a28", "#e8b98f"];

/**
 * How a person walks through an episode: at each row the steps so far and the direction of the body.
 * @param {ArrayLike<number>} stamps @param {(row: number) => number[]} place
 * @returns {{steps: Float32Array, facing: Float32Array, stride: Float32Array}} stride: m of a step, 0 who stands
 */
export function walkOf(stamps, place) {
  const [steps, facing, stride] = [0, 1, 2].map(() => new Float32Array(stamps.length));
  let known = false;
  for (let row = 1; row < stamps.length; row++) {
    const [from, to, dt] = [place(row - 1), place(row), stamps[row] - stamps[row - 1]];
    const way = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const pace = dt > 0 ? way / dt : 0;
    const walks = pace > SLOWEST; // false where it is not there, too
    stride[row] = walks ? Math.sqrt(60 * WALK_RATIO * pace) : 0;
    steps[row] = steps[row - 1] + (walks ? way / stride[row] : 0);
    const wanted = Math.atan2(to[1] - from[1], to[0] - from[0]);
    if (walks && !known) facing.fill(wanted, 0, row); // who stood until now looked where it goes
    known ||= walks;
    facing[row] = walks ? turned(facing[row - 1], wanted, Math.min(1, dt / TURN)) : facing[row - 1];
  }
  return { steps, facing, stride };
}

/** One figure; its front is x. */
export class Figure {
  /** @param {any} three @param {number} number of the person @param {number} radius m */
  constructor(three, number, radius) {
    const tall = 1.62 + 0.22 * ((number * 0.618034) % 1); // m
    const pick = (/** @type {string[]} */ from, /** @type {number} */ by) =>
      new three.MeshLambertMaterial({ color: from[(number * by) % from.length] });
    const [top, trousers, hair, skin] = [pick(TOPS, 1), pick(TROUSERS, 3), pick(HAIR, 2), pick(SKIN, 1)];
    const shoes = new three.MeshLambertMaterial({ color: "#22252b" });
    this.leg = 0.47 * tall;
    this.group = new three.Group();
    const body = new three.Group();
    const trunk = mesh(three, new three.CapsuleGeometry(0.16, 0.19 * tall, 4, 12).rotateX(Math.PI / 2), top);
    trunk.scale.set(0.62, 1, 1);
    trunk.position.z = 0.64 * tall;
    const neck = mesh(three, new three.CylinderGeometry(0.05, 0.055, 0.1, 10).rotateX(Math.PI / 2), skin);
    neck.position.z = 0.83 * tall;
    const head = mesh(three, new three.SphereGeometry(0.105, 16, 12), skin);
    head.scale.set(0.95, 0.82, 1.12);
    head.position.z = 0.915 * tall;
    const cap = mesh(three, new three.SphereGeometry(0.112, 16, 10, 0, 2 * Math.PI, 0, 1.75), hair);
    cap.geometry.rotateX(Math.PI / 2);
    cap.scale.copy(head.scale);
    cap.rotation.y = -0.35; // more hair behind than in front
    cap.position.z = head.position.z + 0.012;
    body.add(trunk, neck, head, cap);
    this.limbs = [1, -1].map((side) => ({
      side,
      leg: this.#leg(three, side, tall, trousers, shoes),
      arm: this.#arm(three, side, tall, top, skin),
    }));
    for (const { leg, arm } of this.limbs) body.add(leg.hip, arm.shoulder);
    this.body = body;
    this.ring = new three.Mesh(
      new three.RingGeometry(0.86 * radius, radius, 40),
      new three.MeshBasicMaterial({ color: "#ffffff", transparent: true, opacity: 0.7, depthWrite: false }),
    );
    this.ring.position.z = 0.014;
    this.group.add(body, this.ring);
  }

  /** @type {(three: any, side: number, tall: number, trousers: any, shoes: any) => any} */
  #leg(three, side, tall, trousers, shoes) {
    const [hip, knee] = [new three.Group(), new three.Group()];
    const half = this.leg / 2;
    const thigh = mesh(three, new three.CapsuleGeometry(0.075, half - 0.1, 4, 10).rotateX(Math.PI / 2), trousers);
    thigh.position.z = -half / 2;
    const shin = mesh(three, new three.CapsuleGeometry(0.058, half - 0.1, 4, 10).rotateX(Math.PI / 2), trousers);
    shin.position.z = -half / 2;
    const shoe = mesh(three, new three.BoxGeometry(0.25, 0.095, 0.07), shoes);
    shoe.position.set(0.055, 0, -half + 0.035);
    knee.position.z = -half;
    knee.add(shin, shoe);
    hip.add(thigh, knee);
    hip.position.set(0, 0.095 * side, 0.5 * tall - 0.03 * tall);
    return { hip, knee };
  }

  /** @type {(three: any, side: number, tall: number, top: any, skin: any) => any} */
  #arm(three, side, tall, top, skin) {
    const [shoulder, elbow] = [new three.Group(), new three.Group()];
    const half = 0.165 * tall;
    const upper = mesh(three, new three.CapsuleGeometry(0.052, half - 0.06, 4, 8).rotateX(Math.PI / 2), top);
    upper.position.z = -half / 2;
    const lower = mesh(three, new three.CapsuleGeometry(0.042, half - 0.06, 4, 8).rotateX(Math.PI / 2), skin);
    lower.position.z = -half / 2;
    elbow.position.z = -half;
    elbow.add(lower);
    shoulder.add(upper, elbow);
    shoulder.position.set(0, 0.21 * side, 0.79 * tall);
    shoulder.rotation.x = 0.1 * side;
    return { shoulder, elbow };
  }

  /**
   * Put the figure where it is and into its step.
   * @param {number[]} place x, y @param {number} facing rad @param {number} steps @param {number} stride m of a step
   * @param {number} state @param {{person: string}} colours
   */
  pose(place, facing, steps, stride, state, colours) {
    this.group.position.set(place[0], place[1], 0);
    this.body.rotation.z = facing;
    this.ring.material.color.set(ofState(state, colours));
    const swing = Math.asin(Math.min(0.7, stride / 2 / this.leg));
    for (const { side, leg, arm } of this.limbs) {
      const phase = Math.PI * steps + (side > 0 ? 0 : Math.PI);
      const forward = Math.sin(phase);
      leg.hip.rotation.y = -swing * forward;
      leg.knee.rotation.y = 1.6 * swing * Math.max(0, Math.cos(phase)); // bent while it comes forward
      arm.shoulder.rotation.y = 0.8 * swing * forward;
      arm.elbow.rotation.y = -0.25 - 0.5 * swing * Math.max(0, -forward);
    }
    this.body.position.z = -this.leg * (1 - Math.cos(swing)) * Math.abs(Math.sin(Math.PI * steps));
  }
}

/** @type {(three: any, geometry: any, material: any) => any} */
function mesh(three, geometry, material) {
  const made = new three.Mesh(geometry, material);
  made.castShadow = true;
  return made;
}
