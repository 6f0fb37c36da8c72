// Curves under the picture, one canvas each, with a cursor at the time that is shown.

import { ROBOTS, ground } from "arena/looks.js";

/**
 * @typedef {{title: string, unit: string, most: number, figures: (episode: import("./episode.js").Episode, row: number)
 * => number}} Curve
 */

/** @type {Curve[]} */
export const CURVES = [
  {
    title: "speed",
    unit: "m/s",
    most: Infinity,
    figures: (episode, row) => Math.hypot(episode.value("twist", row, 0), episode.value("twist", row, 1)),
  },
  { title: "clearance", unit: "m", most: 3, figures: (episode, row) => episode.value("clearance", row) },
  {
    title: "time to collision",
    unit: "s",
    most: 10,
    figures: (episode, row) => episode.value("time_to_collision", row),
  },
];
const [LEFT, RIGHT, TOP, BOTTOM] = [40, 8, 16, 4]; // CSS pixels around a curve

export class Plot {
  /** @param {HTMLCanvasElement} canvas @param {Curve} curve @param {import("./episode.js").Episode[]} episodes */
  constructor(canvas, curve, episodes) {
    this.canvas = canvas;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    this.curve = curve;
    this.episodes = episodes;
    this.end = Math.max(...episodes.map((episode) => episode.end), 0.1);
    this.series = episodes.map((episode) =>
      Array.from({ length: episode.rows }, (_, row) => curve.figures(episode, row)),
    );
    const greatest = Math.max(...this.series.flat().filter(Number.isFinite), 0.1);
    this.top = Math.min(curve.most, 1.08 * greatest);
    this.still = document.createElement("canvas");
  }

  /** The time under a pixel, s. @param {number} x CSS pixels */
  timeAt(x) {
    const width = this.canvas.clientWidth - LEFT - RIGHT;
    return Math.min(this.end, Math.max(0, ((x - LEFT) / width) * this.end));
  }

  /** Draw the curves; to be called again after a change of size or colours. @param {number} ratio */
  layOut(ratio) {
    for (const canvas of [this.canvas, this.still]) {
      canvas.width = Math.round(this.canvas.clientWidth * ratio);
      canvas.height = Math.round(this.canvas.clientHeight * ratio);
    }
    this.ratio = ratio;
    this.colours = ground(this.canvas);
    const context = /** @type {CanvasRenderingContext2D} */ (this.still.getContext("2d"));
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = this.colours.soft;
    context.fillText(`${this.curve.title} [${this.curve.unit}]`, LEFT, 11);
    context.textAlign = "right";
    context.fillText(this.top.toPrecision(2), LEFT - 5, TOP + 9);
    context.fillText("0", LEFT - 5, height - BOTTOM);
    context.textAlign = "left";
    context.strokeStyle = this.colours.faint;
    context.strokeRect(LEFT, TOP, width - LEFT - RIGHT, height - TOP - BOTTOM);
    this.series.forEach((figures, number) => this.#curve(context, figures, number, width, height));
  }

  /**
   * @param {CanvasRenderingContext2D} context
   * @param {number[]} figures
   * @param {number} number
   * @param {number} width
   * @param {number} height
   */
  #curve(context, figures, number, width, height) {
    const { stamps } = this.episodes[number];
    context.beginPath();
    let drawing = false;
    figures.forEach((figure, row) => {
      if (!Number.isFinite(figure)) {
        drawing = false;
        return;
      }
      const x = LEFT + (stamps[row] / this.end) * (width - LEFT - RIGHT);
      const y = height - BOTTOM - (Math.min(figure, this.top) / this.top) * (height - TOP - BOTTOM);
      if (drawing) context.lineTo(x, y);
      else context.moveTo(x, y);
      drawing = true;
    });
    context.strokeStyle = ROBOTS[number % ROBOTS.length];
    context.lineWidth = 1.4;
    context.stroke();
    context.fillStyle = this.colours?.bad ?? "red";
    for (const time of this.episodes[number].collisions) {
      const x = LEFT + (time / this.end) * (width - LEFT - RIGHT);
      context.fillRect(x - 1, height - BOTTOM - 6, 2, 6);
    }
  }

  /** @param {number} time s */
  draw(time) {
    const ratio = this.ratio ?? 1;
    const { context, canvas } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    if (this.still.width) context.drawImage(this.still, 0, 0);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const x = LEFT + (time / this.end) * (canvas.clientWidth - LEFT - RIGHT);
    context.strokeStyle = this.colours?.ink ?? "black";
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(x, TOP);
    context.lineTo(x, canvas.clientHeight - BOTTOM);
    context.stroke();
  }
}
