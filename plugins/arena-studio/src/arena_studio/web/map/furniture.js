// Furniture around a map: pieces of one problem of a scenario file, placed, moved, turned and removed.

import { Autosave } from "studio/edit/autosave.js";
import { latest } from "studio/edit/latest.js";

/**
 * @typedef {[number, number]} Point
 * @typedef {{kind: string, pose: [number, number, number]}} Piece
 * @typedef {{vertices_xy: Point[], radius: number, overhang?: boolean}} Shape
 * @typedef {{path: string, version: string, problems: {name: string, furniture: Piece[]}[]}} File
 */

const TURN = Math.PI / 12;

export class Furniture {
  /**
   * @param {import("../shell/pages.js").Context} context
   * @param {() => import("../edit/undo.js").History | null} history
   * @param {() => void} changed
   * @param {(state: import("../edit/autosave.js").State, said: string) => void} tell
   */
  constructor(context, history, changed, tell) {
    this.context = context;
    this.history = history;
    this.changed = changed;
    this.tell = tell;
    /** @type {Record<string, Shape[]>} */ this.kinds = {};
    /** @type {File[]} */ this.files = [];
    /** @type {File | null} */ this.file = null;
    this.problem = "";
    /** @type {Piece[]} */ this.pieces = [];
    this.chosen = -1;
    this.kind = "";
    /** @type {string | null} */ this.mapPath = null;
    this.loading = latest();
    /** @type {Autosave | null} */ this.autosave = null;
  }

  /**
   * Find the scenario files of a map; the first one is opened, unless another load has begun since.
   * @param {string | null} map
   * @param {string} [path] of the file to open
   */
  async load(map, path = "") {
    const wanted = this.loading();
    await this.autosave?.close();
    if (!Object.keys(this.kinds).length) this.kinds = (await this.context.api.get("/api/maps/furniture")).kinds;
    this.kind ||= Object.keys(this.kinds)[0] ?? "";
    const files = map ? (await this.context.api.get(`/api/maps/scenarios?path=${encodeURIComponent(map)}`)).files : [];
    if (!wanted()) return;
    this.files = files;
    const file = files.find((/** @type {File} */ one) => one.path === path) ?? files[0] ?? null;
    this.mapPath = map;
    this.open(file, file?.problems[0]?.name ?? "");
  }

  /** Show pieces that no file has yet. @param {Piece[]} pieces */
  async loose(pieces) {
    await this.load(null);
    if (this.mapPath !== null) return;
    this.pieces = pieces;
    this.changed();
  }

  /**
   * Make a scenario file for a map with the pieces that there are, and open it.
   * @param {string} map
   * @param {string} path
   */
  async create(map, path) {
    await this.context.api.post("/api/maps/scenarios", { path, map, furniture: this.file ? [] : this.pieces });
    await this.load(map, path);
  }

  /** @param {File | null} file @param {string} problem */
  open(file, problem) {
    void this.autosave?.close();
    const found = file?.problems.find((one) => one.name === problem);
    [this.file, this.problem, this.pieces, this.chosen] = [file, problem, found?.furniture ?? [], -1];
    this.autosave =
      file &&
      new Autosave(
        {
          save: (version) => this.#save(version),
          theirs: () => this.#reload(),
          copy: () => this.#reload(),
          tell: this.tell,
          ask: this.context.ask,
        },
        file.version,
      );
    this.changed();
  }

  /**
   * Put other pieces in the place of those there are, as one step.
   * @param {string} label
   * @param {Piece[]} pieces
   * @param {number} chosen
   */
  set(label, pieces, chosen) {
    const [before, was, file] = [this.pieces, this.chosen, this.file];
    const put = (/** @type {Piece[]} */ those, /** @type {number} */ one) => {
      if (this.file !== file) return; // another file was opened since
      [this.pieces, this.chosen] = [those, one];
      this.autosave?.change();
      this.changed();
    };
    this.history()?.run({ label, do: () => put(pieces, chosen), undo: () => put(before, was) });
  }

  /** @param {Point} point */
  add([x, y]) {
    this.set(
      `place a ${this.kind}`,
      [...this.pieces, { kind: this.kind, pose: [rounded(x), rounded(y), this.pieces[this.chosen]?.pose[2] ?? 0] }],
      this.pieces.length,
    );
  }

  /** @param {Point} point */
  move([x, y]) {
    this.set(
      "move furniture",
      this.#with(([, , theta]) => [rounded(x), rounded(y), theta]),
      this.chosen,
    );
  }

  /** @param {number} way 1: to the left, -1: to the right */
  turn(way) {
    if (this.chosen >= 0)
      this.set(
        "turn furniture",
        this.#with(([x, y, theta]) => [x, y, rounded(theta + way * TURN)]),
        this.chosen,
      );
  }

  remove() {
    if (this.chosen >= 0)
      this.set(
        "remove furniture",
        this.pieces.filter((_, i) => i !== this.chosen),
        -1,
      );
  }

  /** The piece under a point, the last one placed first; -1: none. @param {Point} point */
  under(point) {
    const covered = (/** @type {Piece} */ piece) =>
      (this.kinds[piece.kind] ?? []).some((shape) => covers(shape, inPiece(piece.pose, point)));
    return this.pieces.map(covered).lastIndexOf(true);
  }

  /** @param {(pose: [number, number, number]) => [number, number, number]} change @returns {Piece[]} */
  #with(change) {
    return this.pieces.map((piece, i) => (i === this.chosen ? { ...piece, pose: change(piece.pose) } : piece));
  }

  /** @param {string | null} version @returns {Promise<string>} */
  async #save(version) {
    const { file, problem, pieces } = this;
    if (!file) return "";
    const said = await this.context.api.put(
      "/api/maps/furniture",
      { path: file.path, version, problem, furniture: pieces },
      { version },
    );
    file.version = said.version;
    const found = file.problems.find((one) => one.name === problem);
    if (found) found.furniture = pieces;
    return said.version;
  }

  async #reload() {
    const [file, map] = [this.file?.path ?? "", this.mapPath];
    this.autosave?.loaded(null);
    this.autosave = null;
    await this.load(map, file);
  }
}

/** To a micrometre. @param {number} value */
function rounded(value) {
  return Number(value.toFixed(6));
}

/**
 * Draw pieces: tops lightly, legs darkly.
 * @param {CanvasRenderingContext2D} context
 * @param {Furniture} furniture
 * @param {{wall: string, accent: string}} colours
 * @param {number} pixel m
 */
export function drawPieces(context, furniture, colours, pixel) {
  furniture.pieces.forEach((piece, i) =>
    drawPiece(
      context,
      furniture.kinds[piece.kind] ?? [],
      piece.pose,
      i === furniture.chosen ? colours.accent : colours.wall,
      pixel,
    ),
  );
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Shape[]} shapes
 * @param {number[]} pose
 * @param {string} colour
 * @param {number} pixel m
 */
export function drawPiece(context, shapes, [x, y, theta], colour, pixel) {
  context.save();
  context.translate(x, y);
  context.rotate(theta);
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 1.5 * pixel;
  for (const shape of shapes) {
    context.beginPath();
    if (shape.vertices_xy.length < 3)
      context.arc(shape.vertices_xy[0][0], shape.vertices_xy[0][1], shape.radius, 0, 2 * Math.PI);
    else for (const [u, v] of shape.vertices_xy) context.lineTo(u, v);
    context.closePath();
    context.globalAlpha = shape.overhang ? 0.25 : 0.9;
    context.fill();
    context.globalAlpha = 1;
    context.stroke();
  }
  context.restore();
}

/** @param {number[]} pose @param {Point} point @returns {Point} */
function inPiece([x, y, theta], point) {
  const [dx, dy] = [point[0] - x, point[1] - y];
  const [c, s] = [Math.cos(theta), Math.sin(theta)];
  return [c * dx + s * dy, -s * dx + c * dy];
}

/** @param {Shape} shape @param {Point} point */
function covers({ vertices_xy: vertices, radius }, [x, y]) {
  if (vertices.length < 3) return Math.hypot(x - vertices[0][0], y - vertices[0][1]) <= radius;
  let inside = false;
  vertices.forEach(([x0, y0], i) => {
    const [x1, y1] = vertices[(i + 1) % vertices.length];
    if (y0 > y !== y1 > y && x < x0 + ((y - y0) / (y1 - y0)) * (x1 - x0)) inside = !inside;
  });
  return inside;
}

/**
 * Place, move, turn and remove pieces.
 * @param {Furniture} furniture
 * @param {(hand: import("../edit/tools.js").Hand) => Point} snap
 * @param {() => string} colour
 * @returns {import("../edit/tools.js").Tool}
 */
export function mover(furniture, snap, colour) {
  /** @type {Point | null} */ let grip = null; // from the pointer to the middle of the piece that is dragged
  /** @type {Point | null} */ let to = null;
  return {
    name: "furniture",
    title: "Place furniture, or drag it; [ and ] turn it, Delete removes it",
    key: "t",
    cursor: "pointer",
    down: (hand) => {
      furniture.chosen = furniture.under(hand.point);
      const piece = furniture.pieces[furniture.chosen];
      grip = piece ? [piece.pose[0] - hand.point[0], piece.pose[1] - hand.point[1]] : null;
      to = null;
      if (!piece && furniture.file) furniture.add(snap(hand));
      furniture.changed();
    },
    move: (hand) => {
      if (grip) to = snap({ ...hand, point: [hand.point[0] + grip[0], hand.point[1] + grip[1]] });
    },
    up: () => {
      if (to) furniture.move(to);
      grip = to = null;
    },
    cancel: () => void (grip = to = null),
    press: (event) => {
      if (event.key === "[") furniture.turn(1);
      else if (event.key === "]") furniture.turn(-1);
      else if (event.key === "Delete" || event.key === "Backspace") furniture.remove();
      else return false;
      return true;
    },
    draw: (context, view) => {
      const piece = furniture.pieces[furniture.chosen];
      if (to && piece)
        drawPiece(context, furniture.kinds[piece.kind] ?? [], [...to, piece.pose[2]], colour(), view.pixel);
    },
  };
}
