// Where the solid world is seen from: a hand turns around it, a robot is followed, one looks from its deck, or from
// above.

import { turned } from "arena/episode.js";

export const EYES = ["orbit", "follow", "onboard", "above"];
const LOOK = 0.6; // s of the robot's way, before and after, over which its direction is taken
const FLAT = 0.06; // rad above the floor at least

export class Eye {
  /** @param {any} three @param {number[]} window left, right, bottom, top of what is worth showing, m */
  constructor(three, window) {
    this.three = three;
    this.window = window;
    this.camera = new three.PerspectiveCamera(50, 1, 0.05, 400);
    this.camera.up.set(0, 0, 1);
    this.mode = "orbit";
    /** @type {number[]} */ this.target = [];
    this.azimuth = this.rise = 0;
    this.distance = 0; // 0: as far as it takes to see all
    this.follow = { azimuth: 0, rise: 0, distance: 0 };
    this.reset();
  }

  /** Show the whole world again. */
  reset() {
    const [left, right, bottom, top] = this.window;
    this.target = [(left + right) / 2, (bottom + top) / 2, 0];
    this.azimuth = -Math.PI / 2 - 0.35;
    this.rise = 0.9;
    this.distance = 0;
    this.follow = { azimuth: 0, rise: 0.62, distance: 3.6 };
  }

  /** How far the camera must be to see the whole window. @param {number} aspect */
  #whole(aspect) {
    const [left, right, bottom, top] = this.window;
    const angle = Math.tan((this.camera.fov * Math.PI) / 360);
    return (0.56 * Math.max((right - left) / Math.min(aspect, 2), top - bottom, 2)) / angle;
  }

  /**
   * Put the camera where it belongs.
   * @param {number} aspect @param {import("../episode.js").Episode} episode @param {number} time
   * @param {number} height of what the robot sees with, m
   */
  place(aspect, episode, time, height) {
    const { camera } = this;
    camera.aspect = aspect;
    camera.fov = this.mode === "onboard" ? 72 : 50;
    const pose = episode.at(Math.min(time, episode.end)).pose;
    if (this.mode === "onboard") {
      const deck = 0.8 * episode.said.robot.footprint.radius; // in front of what stands on it
      const [c, s] = [Math.cos(pose[2]), Math.sin(pose[2])];
      camera.position.set(pose[0] + deck * c, pose[1] + deck * s, height);
      camera.lookAt(pose[0] + (deck + 4) * c, pose[1] + (deck + 4) * s, height + 0.1);
    } else if (this.mode === "follow") {
      const { azimuth, rise, distance } = this.follow;
      this.#around([pose[0], pose[1], 0.3], directionAt(episode, time) + Math.PI + azimuth, rise, distance);
    } else if (this.mode === "above") {
      this.#around(this.target, -Math.PI / 2, Math.PI / 2 - 1e-3, this.distance || 1.05 * this.#whole(aspect));
    } else this.#around(this.target, this.azimuth, this.rise, this.distance || this.#whole(aspect));
    camera.updateProjectionMatrix();
  }

  /** @param {number[]} target @param {number} azimuth @param {number} rise @param {number} distance */
  #around(target, azimuth, rise, distance) {
    const flat = distance * Math.cos(rise);
    const [x, y, z] = target;
    this.camera.position.set(x + flat * Math.cos(azimuth), y + flat * Math.sin(azimuth), z + distance * Math.sin(rise));
    this.camera.lookAt(x, y, z);
  }

  /** Turn by a drag of pixels. @param {number} dx @param {number} dy */
  turn(dx, dy) {
    const held = this.mode === "follow" ? this.follow : this;
    held.azimuth -= 0.006 * dx;
    held.rise = Math.min(Math.PI / 2 - 0.01, Math.max(FLAT, held.rise + 0.006 * dy));
  }

  /** Shift what is looked at by a drag. @param {number} dx pixels @param {number} dy @param {number} height of all */
  shift(dx, dy, height) {
    const metre = (2 * this.#distance() * Math.tan((this.camera.fov * Math.PI) / 360)) / height;
    const azimuth = this.mode === "above" ? -Math.PI / 2 : this.azimuth;
    const [c, s] = [Math.cos(azimuth), Math.sin(azimuth)];
    this.target[0] += metre * (s * dx - c * dy);
    this.target[1] += metre * (-c * dx - s * dy);
  }

  #distance() {
    return this.distance || this.#whole(this.camera.aspect);
  }

  /** Come nearer by a factor. @param {number} factor */
  zoom(factor) {
    if (this.mode === "follow") this.follow.distance = Math.min(30, Math.max(0.6, this.follow.distance / factor));
    else this.distance = Math.min(300, Math.max(0.8, this.#distance() / factor));
  }
}

/**
 * Which way a robot goes around a time, rad: an even mean of where it points, so that a camera behind it does not jerk.
 * @param {import("../episode.js").Episode} episode @param {number} time
 */
export function directionAt(episode, time) {
  const middle = episode.at(Math.min(time, episode.end)).pose[2];
  let sum = 0;
  for (let k = -4; k <= 4; k++) {
    const at = Math.min(episode.end, Math.max(0, time + (LOOK * k) / 4));
    sum += turned(0, episode.at(at).pose[2] - middle, 1);
  }
  return middle + sum / 9;
}
