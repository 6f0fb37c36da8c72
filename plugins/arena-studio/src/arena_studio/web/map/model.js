// The map that is open: its cells, keys, steps that can be undone, and what is saved of it.

import { Autosave } from "studio/edit/autosave.js";
import { History } from "studio/edit/undo.js";
import { Grid } from "studio/map/grid.js";
import { kindsOf } from "studio/map/kinds.js";
import { copyName } from "studio/map/names.js";
import { originOf, resized } from "studio/map/resize.js";
import { packed, unpacked, zipped } from "studio/map/transfer.js";

/**
 * @typedef {import("./frame.js").Frame} Frame
 * @typedef {import("./kinds.js").Kind} Kind
 * @typedef {object} Header what the server says of a map beside its cells
 * @property {string | null} path
 * @property {string | null} version null: it is no map file yet, and is kept as a new one
 * @property {number} width
 * @property {number} height
 * @property {number} most_cells that a map may have
 * @property {number} resolution
 * @property {[number, number, number]} origin
 * @property {string} mode
 * @property {string} [image]
 * @property {number} [negate]
 * @property {number[][]} samples
 * @property {number[]} values
 * @property {Record<Kind, number | null>} drawn
 * @property {import("./furniture.js").Piece[]} [furniture] of a world that was drawn with some
 *
 * @typedef {object} Hooks what the page wants to know
 * @property {(box: import("./grid.js").Box) => void} cells
 * @property {() => void} size that the map got another one
 * @property {() => void} steps
 * @property {(state: import("../edit/autosave.js").State, said: string) => void} state
 * @property {(path: string) => void} kept
 * @property {() => Promise<void>} reload
 */

export class OpenMap {
  /**
   * @param {import("../shell/pages.js").Context} context
   * @param {Header} header
   * @param {Uint8Array} cells
   * @param {string} name under which it is kept if it is no file yet
   * @param {Hooks} hooks
   */
  constructor(context, header, cells, name, hooks) {
    this.context = context;
    this.header = header;
    this.name = name;
    this.hooks = hooks;
    this.kinds = kindsOf(header.values);
    this.grid = this.#grid(header.width, header.height, cells);
    this.keysChanged = false;
    this.sizeChanged = false; // since the last save: then all of it is saved
    this.edits = 0; // steps that changed the map
    this.history = new History(() => this.#stepped());
    this.autosave = new Autosave(
      {
        save: (version) => (version === null ? this.#keep(this.name, true) : this.#save(version)),
        theirs: () => hooks.reload(),
        copy: () => this.#rescue(),
        tell: (state, said) => hooks.state(state, said),
        ask: context.ask,
      },
      header.version,
    );
  }

  /** @returns {Frame} */
  get frame() {
    return this.header;
  }

  /** @param {Kind} kind */
  code(kind) {
    return this.header.drawn[kind];
  }

  /**
   * Do one stroke: all that `paint` fills gets a kind's code.
   * @param {string} label
   * @param {Kind} kind
   * @param {(fill: import("./raster.js").Fill) => void} paint
   */
  stroke(label, kind, paint) {
    const code = this.code(kind);
    if (code === null) return;
    this.grid.begin();
    paint((row, left, right) => this.grid.run(row, left, right, code));
    this.endStroke(label);
  }

  /** @param {string} label */
  endStroke(label) {
    const command = this.grid.end(label);
    if (command) this.history.keep(command);
  }

  /**
   * Change scale or origin, as one step.
   * @param {string} label
   * @param {Partial<Pick<Header, "resolution" | "origin">>} keys
   */
  setKeys(label, keys) {
    const { resolution, origin } = this.header;
    const put = (/** @type {typeof keys} */ given) => {
      Object.assign(this.header, given);
      this.keysChanged = true;
    };
    this.history.run({ label, do: () => put(keys), undo: () => put({ resolution, origin }) });
  }

  /**
   * Make the map as large as a box of its cells, as one step; all that is in both stays where it is in the world.
   * @param {string} label @param {import("./grid.js").Box} box @param {Kind} kind of the cells that are new
   */
  resize(label, box, kind) {
    const { width, height, most_cells: most } = this.header;
    const [across, down] = [box.right - box.left, box.bottom - box.top];
    if (across * down > most)
      throw new Error(`The map would have ${across} × ${down} cells; allowed: ${most.toLocaleString("en")} in all.`);
    if (across === width && down === height && !box.left && !box.top) return;
    const before = { grid: this.grid, origin: this.header.origin };
    const { cells } = resized(this.grid, box, this.code(kind) ?? this.code("unknown") ?? this.code("free") ?? 0);
    const after = { grid: this.#grid(across, down, cells), origin: originOf(this.frame, box) };
    const bytes = before.grid.cells.length + cells.length;
    this.history.run({ label, bytes, do: () => this.#put(after), undo: () => this.#put(before) });
  }

  /** @param {{grid: Grid, origin: [number, number, number]}} state strokes of each grid are undone on that one */
  #put({ grid, origin }) {
    this.grid = grid;
    Object.assign(this.header, { width: grid.width, height: grid.height, origin });
    this.keysChanged = this.sizeChanged = true;
    this.hooks.size();
  }

  /** @param {number} width @param {number} height @param {Uint8Array} cells */
  #grid(width, height, cells) {
    return new Grid(width, height, cells, (box) => this.hooks.cells(box));
  }

  /**
   * Keep all of it as a map of another name, and go on with that.
   * @param {string} path
   * @param {boolean} [next] of names that are taken, the next one
   */
  async keepAs(path, next = false) {
    if (this.header.version !== null) await this.autosave.flush();
    this.autosave.loaded(await this.#keep(path, next));
  }

  /** Keep what is here beside what someone else has made of the file. */
  async #rescue() {
    this.autosave.loaded(await this.#keep(copyName(this.header.path ?? this.name), true));
  }

  #stepped() {
    if (this.grid.unsaved.size || this.keysChanged || this.sizeChanged) {
      this.edits += 1;
      this.autosave.change();
    }
    this.hooks.steps();
  }

  /**
   * Take what is not saved yet; `back` says that it is not saved after all.
   * @returns {{boxes: number[][], keys: boolean, back: () => void}}
   */
  #unsaved() {
    const [grid, keys, size] = [this.grid, this.keysChanged, this.sizeChanged];
    const { tiles, boxes } = grid.takeUnsaved();
    this.keysChanged = this.sizeChanged = false;
    const back = () => {
      for (const tile of tiles) grid.unsaved.add(tile);
      this.keysChanged ||= keys;
      this.sizeChanged ||= size;
    };
    return { boxes: size ? [[0, 0, grid.width, grid.height]] : boxes, keys, back };
  }

  /** @param {string} version */
  async #save(version) {
    const { boxes, keys, back } = this.#unsaved();
    const { samples, resolution, origin, path, width, height } = this.header;
    const header = { version, samples, rectangles: boxes, width, height, ...(keys ? { resolution, origin } : {}) };
    try {
      const body = await zipped(packed(header, this.grid.codesOf(boxes)));
      const said = await this.context.api.put(`/api/maps/file?path=${encodeURIComponent(path ?? "")}`, body, {
        version,
      });
      this.header.version = said.version;
      return said.version;
    } catch (error) {
      back();
      throw error;
    }
  }

  /** @param {string} path @param {boolean} next @returns {Promise<string>} the version */
  async #keep(path, next) {
    const { back } = this.#unsaved();
    try {
      const said = await this.#copied(path, this.header.version === null ? null : this.header.path);
      Object.assign(this.header, said);
      this.hooks.kept(said.path);
      return said.version;
    } catch (error) {
      back();
      if (/** @type {any} */ (error).status !== 409 || !next) throw error;
      this.name = copyName(path);
      return this.#keep(this.name, next);
    }
  }

  /**
   * @param {string} path
   * @param {string | null} like the map whose kind of image and comments it gets
   * @returns {Promise<{path: string, version: string, image: string}>}
   */
  async #copied(path, like) {
    const { values: _values, drawn: _drawn, most_cells: _most, ...header } = this.header;
    const body = await zipped(packed({ ...header, like }, this.grid.cells));
    const address = `/api/maps/copy?path=${encodeURIComponent(path)}`;
    return this.context.api.post(address, body).catch((error) => {
      if (error.status !== 404 || like === null) throw error;
      return this.#copied(path, null); // the first map was removed: it cannot be a model any more
    });
  }
}

/**
 * @param {import("../shell/pages.js").Context} context
 * @param {string} path
 * @returns {Promise<{header: Header, cells: Uint8Array}>}
 */
export async function fetchMap(context, path) {
  const { content } = await context.api.bytes(`/api/maps/file?path=${encodeURIComponent(path)}`);
  return unpacked(content);
}

/**
 * @param {import("../shell/pages.js").Context} context
 * @param {{kind: string, seed: number, parameters: Record<string, number | boolean | null>}} drawing
 * @returns {Promise<{header: Header, cells: Uint8Array}>}
 */
export async function drawMap(context, drawing) {
  const words = new URLSearchParams({
    kind: drawing.kind,
    seed: String(drawing.seed),
    parameters: JSON.stringify(drawing.parameters),
  });
  const { content } = await context.api.bytes(`/api/maps/draw?${words}`);
  return unpacked(content);
}
