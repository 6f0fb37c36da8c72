// One canvas in metres: layers that are drawn once a frame at most, a camera, and the hands that move it.

import { Camera } from "arena/camera.js";
import { keyboard } from "studio/edit/keyboard.js";
import { pointers } from "studio/edit/pointers.js";

/**
 * @typedef {[number, number]} Point  m
 * @typedef {{name: string, shown?: boolean, draw: (context: CanvasRenderingContext2D, view: View) => void}} Layer
 * draws in metres, y up
 */

export const MOST_SCALE = 4000; // pixels a metre
const LEAST_SHARE = 0.05; // of the window that the world may shrink to

export class View {
  /** @param {HTMLCanvasElement} canvas @param {Layer[]} layers from the ground up */
  constructor(canvas, layers) {
    this.canvas = canvas;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { alpha: false }));
    this.layers = layers;
    this.camera = new Camera();
    /** @type {import("./tools.js").Tool | null} */ this.tool = null;
    /** @type {number[]} */ this.window = [0, 10, 0, 10]; // left, right, bottom, top of the whole, m
    /** @type {Point | null} */ this.cross = null; // where the keyboard's crosshair is
    this.spaceHeld = false; // while it is, a drag moves the view
    this.step = 0; // m that an arrow key moves the crosshair; 0: eight pixels
    this.background = "#888888";
    this.pane = { x: 0, y: 0, width: 1, height: 1 };
    this.ratio = 1;
    this.frame = 0;
    this.drawn = 0; // frames
    this.watcher = new ResizeObserver(() => this.#resize());
    this.watcher.observe(canvas);
    this.drop = [pointers(this), keyboard(this)];
    this.#resize();
  }

  /** Metres of a CSS pixel. */
  get pixel() {
    return 1 / this.camera.scale;
  }

  /** The corners of what is seen: left, right, bottom, top, m. */
  get seen() {
    const [left, top] = this.camera.point(this.pane, 0, 0);
    const [right, bottom] = this.camera.point(this.pane, this.pane.width, this.pane.height);
    return [left, right, bottom, top];
  }

  /** Draw soon: all requests of a frame are one drawing. */
  request() {
    if (!this.frame) this.frame = requestAnimationFrame(() => this.draw());
  }

  /** Draw now. */
  draw() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.drawn += 1;
    const { context, canvas } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = this.background;
    context.fillRect(0, 0, canvas.width, canvas.height);
    for (const layer of this.layers) if (layer.shown !== false) this.#layer((into) => layer.draw(into, this));
    if (this.tool?.draw) this.#layer((into) => this.tool?.draw?.(into, this));
    if (this.cross) this.#layer((into) => drawCross(into, this));
  }

  /** Show the whole. @param {number[]} [window] left, right, bottom, top, m */
  fit(window = this.window) {
    this.window = window;
    this.camera.fit(window, this.pane.width, this.pane.height);
    this.request();
  }

  /** The point under a pixel of the canvas. @param {number} x @param {number} y @returns {Point} */
  point(x, y) {
    const [u, v] = this.camera.point(this.pane, x, y);
    return [u, v];
  }

  /** The pixel of the canvas over a point. @param {Point} point @returns {Point} */
  over([x, y]) {
    const { camera, pane } = this;
    return [pane.width / 2 + camera.scale * (x - camera.x), pane.height / 2 - camera.scale * (y - camera.y)];
  }

  /**
   * Zoom and keep the point under a pixel where it is.
   * @param {number} factor
   * @param {number} [x]
   * @param {number} [y]
   */
  zoom(factor, x = this.pane.width / 2, y = this.pane.height / 2) {
    const [left, right, bottom, top] = this.window;
    const least =
      LEAST_SHARE * Math.min(this.pane.width / Math.max(right - left, 1), this.pane.height / Math.max(top - bottom, 1));
    const [u, v] = this.point(x, y);
    this.camera.scale = Math.min(MOST_SCALE, Math.max(least, this.camera.scale * factor));
    const [p, q] = this.point(x, y);
    this.camera.x += u - p;
    this.camera.y += v - q;
    this.request();
  }

  /** Move by pixels. @param {number} dx @param {number} dy */
  pan(dx, dy) {
    this.camera.pan(dx, dy);
    this.request();
  }

  /** Let go of everything. */
  close() {
    cancelAnimationFrame(this.frame);
    this.watcher.disconnect();
    for (const drop of this.drop) drop();
  }

  /** @param {(context: CanvasRenderingContext2D) => void} draw */
  #layer(draw) {
    this.context.save();
    this.camera.apply(this.context, this.pane, this.ratio);
    draw(this.context);
    this.context.restore();
  }

  #resize() {
    const first = this.pane.width <= 1;
    this.ratio = devicePixelRatio || 1;
    this.pane = {
      x: 0,
      y: 0,
      width: Math.max(this.canvas.clientWidth, 1),
      height: Math.max(this.canvas.clientHeight, 1),
    };
    this.canvas.width = Math.round(this.pane.width * this.ratio);
    this.canvas.height = Math.round(this.pane.height * this.ratio);
    if (first) this.fit();
    this.draw(); // a canvas that got another size is empty until then
  }
}

/** @param {CanvasRenderingContext2D} context @param {View} view */
function drawCross(context, view) {
  const [x, y] = /** @type {Point} */ (view.cross);
  const arm = 12 * view.pixel;
  for (const [colour, width] of [
    ["#ffffff", 4],
    ["#000000", 2],
  ]) {
    context.strokeStyle = /** @type {string} */ (colour);
    context.lineWidth = Number(width) * view.pixel;
    context.beginPath();
    context.moveTo(x - arm, y);
    context.lineTo(x + arm, y);
    context.moveTo(x, y - arm);
    context.lineTo(x, y + arm);
    context.stroke();
  }
}
