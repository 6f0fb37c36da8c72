// Where a canvas looks: a centre in the map, and how many pixels a metre has. y of the map goes up.

export class Camera {
  constructor() {
    this.x = 0;
    this.y = 0;
    this.scale = 40; // pixels a metre
  }

  /**
   * Show a window of the map in a pane.
   * @param {number[]} window left, right, bottom, top, m
   * @param {number} width
   * @param {number} height
   */
  fit(window, width, height) {
    const [left, right, bottom, top] = window;
    this.x = (left + right) / 2;
    this.y = (bottom + top) / 2;
    this.scale = 0.96 * Math.min(width / Math.max(right - left, 1), height / Math.max(top - bottom, 1));
  }

  /**
   * Set a context's transform, so that it draws in metres.
   * @param {CanvasRenderingContext2D} context
   * @param {any} pane
   * @param {number} ratio
   */
  apply(context, pane, ratio) {
    const k = this.scale * ratio;
    context.setTransform(
      k,
      0,
      0,
      -k,
      ratio * (pane.x + pane.width / 2) - k * this.x,
      ratio * (pane.y + pane.height / 2) + k * this.y,
    );
  }

  /** The point of the map under a pixel of a pane. @param {any} pane @param {number} px @param {number} py */
  point(pane, px, py) {
    return [
      this.x + (px - pane.x - pane.width / 2) / this.scale,
      this.y - (py - pane.y - pane.height / 2) / this.scale,
    ];
  }

  /**
   * Zoom, and keep the point under the pointer where it is.
   * @param {number} factor
   * @param {any} pane
   * @param {number} px
   * @param {number} py
   */
  zoom(factor, pane, px, py) {
    const [x, y] = this.point(pane, px, py);
    this.scale = Math.min(2000, Math.max(2, this.scale * factor));
    const [u, v] = this.point(pane, px, py);
    this.x += x - u;
    this.y += y - v;
  }

  /** Move by pixels. @param {number} dx @param {number} dy */
  pan(dx, dy) {
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
  }
}

/**
 * Return what of a map is worth showing: its free cells and a margin; of an episode without a map, where it drove.
 * @param {import("./episode.js").Episode} episode
 * @returns {number[]} left, right, bottom, top, m
 */
export function windowOf(episode) {
  const margin = 0.6;
  const xs = [episode.said.goal[0]];
  const ys = [episode.said.goal[1]];
  if (episode.map) {
    const [height, width] = episode.map.cells.shape;
    const { resolution, origin } = episode.map;
    const [c, s] = [Math.cos(origin[2]), Math.sin(origin[2])];
    let [left, right, bottom, top] = [width, 0, height, 0];
    for (let j = 0; j < height; j++) {
      for (let i = 0; i < width; i++) {
        if (episode.map.cells.values[j * width + i] !== 0) continue;
        left = Math.min(left, i);
        right = Math.max(right, i + 1);
        bottom = Math.min(bottom, j);
        top = Math.max(top, j + 1);
      }
    }
    for (const i of [left, right]) {
      for (const j of [bottom, top]) {
        xs.push(origin[0] + resolution * (c * i - s * j));
        ys.push(origin[1] + resolution * (s * i + c * j));
      }
    }
  } else {
    for (let row = 0; row < episode.rows; row++) {
      xs.push(episode.value("pose", row, 0));
      ys.push(episode.value("pose", row, 1));
    }
  }
  return [Math.min(...xs) - margin, Math.max(...xs) + margin, Math.min(...ys) - margin, Math.max(...ys) + margin];
}
