// What is no body: beams, ways, trails, contacts, names.

import { rangesOf } from "arena/lidar.js";

/** A line near the floor that is drawn again when its points are others. */
export class Way {
  /** @param {any} three @param {string} colour @param {number} height m @param {boolean} dashed */
  constructor(three, colour, height, dashed) {
    this.three = three;
    this.height = height;
    this.dashed = dashed;
    const kind = dashed ? three.LineDashedMaterial : three.LineBasicMaterial;
    const dashes = dashed ? { dashSize: 0.18, gapSize: 0.1 } : {};
    this.line = new three.Line(new three.BufferGeometry(), new kind({ color: colour, ...dashes }));
    this.line.frustumCulled = false;
    /** @type {number[][]} */ this.points = [];
  }

  /** @param {number[][]} points */
  draw(points) {
    this.line.visible = points.length > 1;
    const same =
      points.length === this.points.length && (!points.length || String(points.at(-1)) === String(this.points.at(-1)));
    if (same && String(points[0]) === String(this.points[0])) return;
    this.points = points;
    const places = new Float32Array(3 * points.length);
    points.forEach(([x, y], i) => places.set([x, y, this.height], 3 * i));
    this.line.geometry.dispose();
    this.line.geometry = new this.three.BufferGeometry();
    this.line.geometry.setAttribute("position", new this.three.BufferAttribute(places, 3));
    if (this.dashed) this.line.computeLineDistances();
  }
}

/** The way that a robot has come, all of it laid out once. */
export class Trail {
  /** @param {any} three @param {import("../episode.js").Episode} episode @param {string} colour */
  constructor(three, episode, colour) {
    const { values, rows } = episode.arrays.pose;
    const places = new Float32Array(3 * rows);
    for (let row = 0; row < rows; row++) places.set([values[row], values[rows + row], 0.018], 3 * row);
    const geometry = new three.BufferGeometry();
    geometry.setAttribute("position", new three.BufferAttribute(places, 3));
    this.line = new three.Line(geometry, new three.LineBasicMaterial({ color: colour }));
    this.line.frustumCulled = false;
  }

  /** @param {number} row up to which it is shown */
  draw(row) {
    this.line.geometry.setDrawRange(0, row + 1);
  }
}

/** Beams of a lidar: thin rays, and points where they end. */
export class Beams {
  /** @param {any} three @param {any} lidar @param {number} height m @param {string} colour */
  constructor(three, lidar, height, colour) {
    this.lidar = lidar;
    this.height = height;
    this.group = new three.Group();
    this.rays = new Float32Array(6 * lidar.beams);
    this.ends = new Float32Array(3 * lidar.beams);
    const [rays, ends] = [new three.BufferGeometry(), new three.BufferGeometry()];
    rays.setAttribute("position", new three.BufferAttribute(this.rays, 3));
    ends.setAttribute("position", new three.BufferAttribute(this.ends, 3));
    const faint = new three.LineBasicMaterial({ color: colour, transparent: true, opacity: 0.13, depthWrite: false });
    const lines = new three.LineSegments(rays, faint);
    const points = new three.Points(ends, new three.PointsMaterial({ color: colour, size: 3, sizeAttenuation: false }));
    lines.frustumCulled = points.frustumCulled = false;
    this.geometries = [rays, ends];
    this.group.add(lines, points);
  }

  /** @param {import("../episode.js").Episode} episode @param {import("../episode.js").Moment} moment */
  draw(episode, moment) {
    const { lidar, rays, ends, height } = this;
    const { pose } = moment;
    const ranges = rangesOf(episode, moment);
    const [c, s] = [Math.cos(pose[2]), Math.sin(pose[2])];
    const [x, y] = [pose[0] + c * lidar.mount.x - s * lidar.mount.y, pose[1] + s * lidar.mount.x + c * lidar.mount.y];
    const first = pose[2] + lidar.mount.theta + lidar.angle_min;
    for (let beam = 0; beam < lidar.beams; beam++) {
      const range = ranges[beam];
      const seen = range <= lidar.range_max;
      const angle = first + beam * lidar.angle_increment;
      const end = seen ? [x + range * Math.cos(angle), y + range * Math.sin(angle), height] : [x, y, -10];
      rays.set([x, y, height, ...(seen ? end : [x, y, height])], 6 * beam);
      ends.set(end, 3 * beam);
    }
    for (const geometry of this.geometries) geometry.attributes.position.needsUpdate = true;
  }
}

/** Rings where a robot touched something in the last two seconds. */
export class Touches {
  /** @param {any} three @param {string} colour */
  constructor(three, colour) {
    this.group = new three.Group();
    const geometry = new three.RingGeometry(0.85, 1, 40);
    this.rings = [0, 1, 2, 3].map(() => {
      const material = new three.MeshBasicMaterial({ color: colour, transparent: true, depthWrite: false });
      const ring = new three.Mesh(geometry, material);
      ring.position.z = 0.022;
      this.group.add(ring);
      return ring;
    });
  }

  /** @param {import("../episode.js").Episode} episode @param {number} time */
  draw(episode, time) {
    const recent = episode.contacts.filter(({ stamp }) => time >= stamp && time - stamp <= 2).slice(-this.rings.length);
    this.rings.forEach((ring, i) => {
      ring.visible = i < recent.length;
      if (!ring.visible) return;
      const ago = time - recent[i].stamp;
      ring.position.x = recent[i].x;
      ring.position.y = recent[i].y;
      ring.scale.setScalar(0.35 + 0.3 * ago);
      ring.material.opacity = 1 - ago / 2;
    });
  }
}

/** A name that always faces the camera. @param {any} three @param {string} text @param {string} colour */
export function nameOf(three, text, colour) {
  const canvas = document.createElement("canvas");
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const font = "600 44px system-ui, sans-serif";
  context.font = font;
  [canvas.width, canvas.height] = [Math.ceil(context.measureText(text).width) + 36, 64];
  context.fillStyle = colour;
  context.beginPath();
  context.roundRect(0, 0, canvas.width, canvas.height, 18);
  context.fill();
  context.font = font;
  context.fillStyle = "#ffffff";
  context.textBaseline = "middle";
  context.fillText(text, 18, 34);
  const texture = new three.CanvasTexture(canvas);
  texture.colorSpace = three.SRGBColorSpace;
  const sprite = new three.Sprite(new three.SpriteMaterial({ map: texture, depthTest: false }));
  sprite.scale.set((0.3 * canvas.width) / canvas.height, 0.3, 1);
  return sprite;
}
