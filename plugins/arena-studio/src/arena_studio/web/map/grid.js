// The cells of a map, one byte each, and what a stroke changed in them: as a command that can be undone, and as tiles
// that are not saved yet.

export const TILE = 128; // cells along the side of a tile

/** @typedef {{left: number, top: number, right: number, bottom: number}} Box  of cells; right and bottom are outside */

export class Grid {
  /**
   * @param {number} width
   * @param {number} height
   * @param {Uint8Array} cells row 0 at the top
   * @param {(box: Box) => void} [changed]
   */
  constructor(width, height, cells, changed = () => {}) {
    this.width = width;
    this.height = height;
    this.cells = cells;
    this.changed = changed;
    this.across = Math.ceil(width / TILE);
    /** @type {Set<number>} */ this.unsaved = new Set(); // tiles
    // tiles as they were when the stroke began
    /** @type {Map<number, Uint8Array | number> | null} */ this.before = null;
    /** @type {Box | null} */ this.box = null;
  }

  /** The code of a cell; -1 outside. @param {number} column @param {number} row */
  at(column, row) {
    return column >= 0 && row >= 0 && column < this.width && row < this.height
      ? this.cells[row * this.width + column]
      : -1;
  }

  /** Begin a stroke. */
  begin() {
    this.before = new Map();
  }

  /**
   * Give the cells of a run a code, those inside the map.
   * @param {number} row
   * @param {number} left
   * @param {number} right
   * @param {number} code
   */
  run(row, left, right, code) {
    if (row < 0 || row >= this.height) return;
    [left, right] = [Math.max(left, 0), Math.min(right, this.width)];
    if (right <= left) return;
    this.#keep(row, left, right);
    this.cells.fill(code, row * this.width + left, row * this.width + right);
    this.#grow({ left, top: row, right, bottom: row + 1 });
  }

  /** Tell the view what was changed since the last time. */
  tell() {
    if (this.box) this.changed(this.box);
    this.box = null;
  }

  /**
   * End a stroke; return it as a command that is done already, null where it changed nothing.
   * @param {string} label
   * @returns {import("../edit/undo.js").Command | null}
   */
  end(label) {
    const before = this.before ?? new Map();
    this.before = null;
    this.tell();
    /** @type {[number, Uint8Array | number, Uint8Array | number][]} */ const tiles = [];
    for (const [tile, was] of before) {
      const is = this.#tile(tile);
      if (!same(was, is)) tiles.push([tile, was, is]);
    }
    if (!tiles.length) return null;
    const bytes = tiles.reduce((sum, [, was, is]) => sum + size(was) + size(is), 0);
    for (const [tile] of tiles) this.unsaved.add(tile);
    return {
      label,
      bytes,
      do: () => tiles.forEach(([tile, , is]) => this.#put(tile, is)),
      undo: () => tiles.forEach(([tile, was]) => this.#put(tile, was)),
    };
  }

  /** Take back a stroke that was begun. */
  cancel() {
    const before = this.before ?? new Map();
    this.before = null;
    for (const [tile, was] of before) this.#put(tile, was, false);
    this.tell();
  }

  /**
   * Take the tiles that are not saved yet as rectangles of whole tiles: left, top, width, height. They count as saved.
   */
  takeUnsaved() {
    const tiles = [...this.unsaved].sort((a, b) => a - b);
    this.unsaved.clear();
    /** @type {number[][]} */ const boxes = [];
    let last = -2;
    for (const tile of tiles) {
      const box = this.boxOf(tile);
      const before = boxes.at(-1);
      if (before && tile === last + 1 && tile % this.across) before[2] = box.right - before[0];
      else boxes.push([box.left, box.top, box.right - box.left, box.bottom - box.top]);
      last = tile;
    }
    return { tiles, boxes };
  }

  /** The codes of rectangles, one after the other. @param {number[][]} boxes left, top, width, height */
  codesOf(boxes) {
    const codes = new Uint8Array(boxes.reduce((sum, [, , width, height]) => sum + width * height, 0));
    let end = 0;
    for (const [left, top, width, height] of boxes) {
      for (let row = top; row < top + height; row++, end += width)
        codes.set(this.cells.subarray(row * this.width + left, row * this.width + left + width), end);
    }
    return codes;
  }

  /** @param {number} tile @returns {Box} */
  boxOf(tile) {
    const [left, top] = [TILE * (tile % this.across), TILE * Math.floor(tile / this.across)];
    return { left, top, right: Math.min(left + TILE, this.width), bottom: Math.min(top + TILE, this.height) };
  }

  /**
   * Keep the tiles under a run as they are before the stroke.
   * @param {number} row
   * @param {number} left
   * @param {number} right
   */
  #keep(row, left, right) {
    if (!this.before) return;
    const first = this.across * Math.floor(row / TILE);
    for (let tile = first + Math.floor(left / TILE); tile <= first + Math.floor((right - 1) / TILE); tile++) {
      if (!this.before.has(tile)) this.before.set(tile, this.#tile(tile));
    }
  }

  /** A tile's codes; one number where all are the same. @param {number} tile */
  #tile(tile) {
    const box = this.boxOf(tile);
    const codes = this.codesOf([[box.left, box.top, box.right - box.left, box.bottom - box.top]]);
    for (let i = 1; i < codes.length; i++) if (codes[i] !== codes[0]) return codes;
    return codes[0];
  }

  /** @param {number} tile @param {Uint8Array | number} codes @param {boolean} [unsaved] */
  #put(tile, codes, unsaved = true) {
    const box = this.boxOf(tile);
    const width = box.right - box.left;
    for (let row = box.top; row < box.bottom; row++) {
      const at = row * this.width + box.left;
      if (typeof codes === "number") this.cells.fill(codes, at, at + width);
      else this.cells.set(codes.subarray((row - box.top) * width, (row - box.top + 1) * width), at);
    }
    if (unsaved) this.unsaved.add(tile);
    this.changed(box);
  }

  /** @param {Box} box */
  #grow(box) {
    this.box = this.box ? union(this.box, box) : box;
  }
}

/** @param {Box} a @param {Box} b @returns {Box} */
export function union(a, b) {
  return {
    left: Math.min(a.left, b.left),
    top: Math.min(a.top, b.top),
    right: Math.max(a.right, b.right),
    bottom: Math.max(a.bottom, b.bottom),
  };
}

/** @param {Uint8Array | number} a @param {Uint8Array | number} b */
function same(a, b) {
  if (typeof a === "number" || typeof b === "number") return a === b;
  for (let i = 0; i < a.length; i++) if (a[i] !== b[i]) return false;
  return true;
}

/** @param {Uint8Array | number} codes */
function size(codes) {
  return typeof codes === "number" ? 8 : codes.length;
}
