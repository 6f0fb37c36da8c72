// A map's picture: tiles of canvases in several sizes, made when they are seen and mended where the map changed.

import { union } from "studio/map/grid.js";

/** @typedef {import("./grid.js").Box} Box */
/**
 * @typedef {{canvas: OffscreenCanvas, context: OffscreenCanvasRenderingContext2D, level: number, left: number, top:
 * number, stale: Box | null, used: number}} Tile
 */

const SIDE = 512; // pixels
const MOST_TILES = 120; // a megabyte each

export class Tiles {
  /**
   * @param {import("./grid.js").Grid} grid
   * @param {Uint32Array} colours of the codes
   * @param {Uint8Array} ranks which code is seen where a pixel has several: the highest
   */
  constructor(grid, colours, ranks) {
    this.grid = grid;
    this.colours = colours;
    this.ranks = ranks;
    /** @type {Map<string, Tile>} */ this.tiles = new Map();
    this.turn = 0;
  }

  /** Have a part of the map drawn again when it is seen next. @param {Box} box */
  change(box) {
    for (const tile of this.tiles.values()) {
      const cells = this.#boxOf(tile);
      if (box.left >= cells.right || box.right <= cells.left || box.top >= cells.bottom || box.bottom <= cells.top)
        continue;
      tile.stale = tile.stale ? union(tile.stale, box) : box;
    }
  }

  /**
   * Draw what is seen of the map.
   * @param {CanvasRenderingContext2D} context in cells
   * @param {Box} seen
   * @param {number} scale device pixels a cell
   */
  draw(context, seen, scale) {
    this.turn += 1;
    const level = Math.max(0, Math.floor(Math.log2(1 / scale) + 0.01));
    const side = SIDE << level;
    context.imageSmoothingEnabled = scale * 2 ** level < 1;
    const [left, top] = [Math.max(0, Math.floor(seen.left / side)), Math.max(0, Math.floor(seen.top / side))];
    const [right, bottom] = [Math.min(seen.right, this.grid.width), Math.min(seen.bottom, this.grid.height)];
    for (let y = top; y * side < bottom; y++) {
      for (let x = left; x * side < right; x++) place(context, this.#tile(level, x, y), side, scale);
    }
    this.#forget();
  }

  /** @param {number} level @param {number} x @param {number} y */
  #tile(level, x, y) {
    const key = `${level}/${x}/${y}`;
    let tile = this.tiles.get(key);
    if (!tile) {
      const canvas = new OffscreenCanvas(SIDE, SIDE);
      const context = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext("2d"));
      const [left, top] = [(x * SIDE) << level, (y * SIDE) << level];
      tile = {
        canvas,
        context,
        level,
        left,
        top,
        stale: { left, top, right: left + (SIDE << level), bottom: top + (SIDE << level) },
        used: 0,
      };
      this.tiles.set(key, tile);
    }
    if (tile.stale) this.#paint(tile, tile.stale);
    tile.stale = null;
    tile.used = this.turn;
    return tile;
  }

  /** @param {Tile} tile @returns {Box} */
  #boxOf({ left, top, level }) {
    return { left, top, right: left + (SIDE << level), bottom: top + (SIDE << level) };
  }

  /** Paint the pixels of a tile that cells of a box lie in. @param {Tile} tile @param {Box} box */
  #paint(tile, box) {
    const { grid } = this;
    const cells = this.#boxOf(tile);
    const [right, bottom] = [
      Math.min(box.right, cells.right, grid.width),
      Math.min(box.bottom, cells.bottom, grid.height),
    ];
    const x0 = (Math.max(box.left, cells.left) - tile.left) >> tile.level;
    const y0 = (Math.max(box.top, cells.top) - tile.top) >> tile.level;
    const [x1, y1] = [
      (right - tile.left + 2 ** tile.level - 1) >> tile.level,
      (bottom - tile.top + 2 ** tile.level - 1) >> tile.level,
    ];
    if (x1 <= x0 || y1 <= y0) return;
    const image = new ImageData(x1 - x0, y1 - y0);
    const pixels = new Uint32Array(image.data.buffer);
    if (tile.level) this.#reduce(tile, pixels, x0, y0, x1, y1);
    else this.#plain(tile, pixels, x0, y0, x1, y1);
    tile.context.putImageData(image, x0, y0);
  }

  /**
   * @param {Tile} tile
   * @param {Uint32Array} pixels
   * @param {number} x0
   * @param {number} y0
   * @param {number} x1
   * @param {number} y1
   */
  #plain(tile, pixels, x0, y0, x1, y1) {
    const { cells, width } = this.grid;
    const { colours } = this;
    let i = 0;
    for (let y = y0; y < y1; y++) {
      let at = (tile.top + y) * width + tile.left + x0;
      for (let x = x0; x < x1; x++) pixels[i++] = colours[cells[at++]];
    }
  }

  /**
   * Several cells a pixel: the one of the highest rank is seen, so that no thin wall is lost.
   * @param {Tile} tile
   * @param {Uint32Array} pixels
   * @param {number} x0
   * @param {number} y0
   * @param {number} x1
   * @param {number} y1
   */
  #reduce(tile, pixels, x0, y0, x1, y1) {
    const { cells, width, height } = this.grid;
    const { colours, ranks } = this;
    const [side, count] = [2 ** tile.level, x1 - x0];
    const best = new Uint8Array(count);
    for (let y = y0; y < y1; y++) {
      const [first, last] = [tile.top + y * side, Math.min(tile.top + (y + 1) * side, height)];
      const from = tile.left + x0 * side;
      const to = Math.min(tile.left + x1 * side, width);
      best.fill(cells[first * width + from]);
      for (let row = first; row < last; row++) {
        for (let column = from, at = row * width + from; column < to; column++, at++) {
          const i = (column - from) >> tile.level;
          if (ranks[cells[at]] > ranks[best[i]] || (row === first && ((column - from) & (side - 1)) === 0))
            best[i] = cells[at];
        }
      }
      for (let i = 0; i < count; i++) pixels[(y - y0) * count + i] = colours[best[i]];
    }
  }

  /** Let go of the tiles that were not seen for longest. */
  #forget() {
    if (this.tiles.size <= MOST_TILES) return;
    const oldest = [...this.tiles].sort(([, a], [, b]) => a.used - b.used).slice(0, this.tiles.size - MOST_TILES);
    for (const [key, tile] of oldest) if (tile.used !== this.turn) this.tiles.delete(key);
  }
}

/**
 * Draw a tile; its edges lie on whole pixels where the map is not turned, so that no seam is seen.
 * @param {CanvasRenderingContext2D} context
 * @param {Tile} tile
 * @param {number} side cells
 * @param {number} scale
 */
function place(context, tile, side, scale) {
  const { a, b, c, d, e, f } = context.getTransform();
  if (Math.abs(b) > 1e-9 || Math.abs(c) > 1e-9) {
    const seam = 0.5 / scale;
    context.drawImage(tile.canvas, tile.left, tile.top, side + seam, side + seam);
    return;
  }
  const [x0, x1] = [tile.left, tile.left + side].map((column) => Math.round(a * column + e));
  const [y0, y1] = [tile.top, tile.top + side].map((row) => Math.round(d * row + f));
  context.save();
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.drawImage(tile.canvas, x0, y0, x1 - x0, y1 - y0);
  context.restore();
}
