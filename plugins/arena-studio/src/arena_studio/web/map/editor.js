// The map editor: joins the open map, the view, the tools and the panels.

import { latest } from "studio/edit/latest.js";
import { isWriting, PAN, Toolbox, undoKeys } from "studio/edit/tools.js";
import { View } from "studio/edit/view.js";
import { box, brush, bucket, corners, ruler, walls } from "studio/map/drawing.js";
import { extent } from "studio/map/extent.js";
import { snapped, toCells, windowOf } from "studio/map/frame.js";
import { drawPieces, Furniture, mover } from "studio/map/furniture.js";
import { coloursOf, kindOf, NAMES, ranksOf } from "studio/map/kinds.js";
import { drawMap, fetchMap, OpenMap } from "studio/map/model.js";
import { edges, ground, lattice, scaleBar } from "studio/map/scenery.js";
import { Tiles } from "studio/map/tiles.js";

const COLOURS = /** @type {const} */ ([
  "free",
  "wall",
  "unknown",
  "ink",
  "paper",
  "line",
  "faint",
  "accent",
  "person",
  "path",
]);

/** @typedef {Record<typeof COLOURS[number], string>} Colours */

export class Editor {
  /**
   * @param {import("../shell/pages.js").Context} context
   * @param {HTMLCanvasElement} canvas
   * @param {() => void} changed what the panels say is old
   * @param {(state: import("../edit/autosave.js").State, said: string) => void} tell
   * @param {(text: string) => void} pointAt
   */
  constructor(context, canvas, changed, tell, pointAt) {
    this.context = context;
    this.changed = changed;
    this.tell = tell;
    this.pointAt = pointAt;
    this.opening = latest();
    /** @type {OpenMap | null} */ this.map = null;
    /** @type {Tiles | null} */ this.tiles = null;
    /** @type {import("./drawing.js").Pencil} */ this.pencil = {
      kind: "occupied",
      width: 0.2,
      filled: false,
      step: 0.1,
      beyond: "unknown",
    };
    /** @type {{metres: number, cells: number} | null} */ this.measured = null;
    this.colours = coloursOfPage(canvas);
    this.furniture = new Furniture(
      context,
      () => this.map?.history ?? null,
      () => this.show(),
      tell,
    );
    this.view = this.#view(canvas);
    this.toolbox = new Toolbox(this.view, this.#tools());
    this.dark = matchMedia("(prefers-color-scheme: dark)");
    this.dark.addEventListener("change", this.recolour);
  }

  /** Bring view and panels up to date. */
  show() {
    this.changed();
    this.view.request();
  }

  /** @param {Partial<import("./drawing.js").Pencil>} change */
  setPencil(change) {
    Object.assign(this.pencil, change);
    this.view.step = this.pencil.step;
    this.show();
  }

  /**
   * Crop or enlarge the map.
   * @param {string} label
   * @param {import("./grid.js").Box} sides of it, in its cells as they are
   */
  resize(label, sides) {
    void this.trying(async () => {
      this.map?.resize(label, sides, this.pencil.beyond);
      if (this.map)
        this.context.say(
          `The map has ${this.map.grid.width} × ${this.map.grid.height} cells now; Ctrl Z brings back what it was.`,
        );
    });
  }

  /** Do what may fail, and say why it did. @param {() => Promise<void>} act */
  async trying(act) {
    try {
      await act();
    } catch (error) {
      this.context.say(error instanceof Error ? error.message : String(error), "error");
    }
  }

  /** Open a map of the project. @param {string} path */
  async open(path) {
    const wanted = this.opening();
    const { header, cells } = await fetchMap(this.context, path);
    if (!wanted()) return;
    await this.#leave();
    this.#take(header, cells, path.replace(/(\.world)?\.\w+$/, "_map.yaml"));
    await this.furniture.load(path);
    if (header.version === null)
      this.context.say(`${path} cannot be changed as it is; what you draw is kept as ${this.map?.name}`);
  }

  /**
   * Draw a world.
   * @param {{kind: string, seed: number, parameters: Record<string, number | boolean | null>}} drawing
   */
  async drawWorld(drawing) {
    const wanted = this.opening();
    const { header, cells } = await drawMap(this.context, drawing);
    if (!wanted()) return;
    await this.#leave();
    this.#take(header, cells, `maps/${drawing.kind}_${drawing.seed}.yaml`);
    await this.furniture.loose(header.furniture ?? []);
  }

  /** Make a scenario file for the map, and open it. */
  async newScenario() {
    const map = this.map?.header.path ?? "";
    await this.map?.autosave.flush();
    await this.furniture.create(map, scenarioName(map));
    this.toolbox.choose("furniture");
  }

  /** Load the map again if someone else has changed it and nothing here is unsaved. */
  async refresh() {
    const { map } = this;
    if (!map?.header.path || map.header.version === null || map.autosave.state !== "saved" || map.autosave.unsaved)
      return;
    const { version } = await this.context.api.get(`/api/maps/version?path=${encodeURIComponent(map.header.path)}`);
    if (version === map.header.version || map !== this.map || map.autosave.state !== "saved" || map.autosave.unsaved)
      return;
    await this.#reload();
    this.context.say("The map was changed by another window or program and is shown again.");
  }

  /** @param {KeyboardEvent} event */
  press(event) {
    if (isWriting(event.target) || event.defaultPrevented) return;
    if (this.map && !this.map.grid.before && undoKeys(event, this.map.history)) return this.show();
    const kind = NAMES[["1", "2", "3"].indexOf(event.key)];
    if (kind && !event.ctrlKey && !event.metaKey && !event.altKey) this.setPencil({ kind });
    else if (!this.toolbox.press(event)) return;
    event.preventDefault();
    this.view.request();
  }

  recolour = () => {
    this.colours = coloursOfPage(this.view.canvas);
    this.#paint();
    this.view.request();
  };

  /** Save what is left and let go of everything. */
  async close() {
    this.dark.removeEventListener("change", this.recolour);
    this.view.close();
    await this.#leave();
    await this.furniture.autosave?.close();
  }

  async #leave() {
    if (this.map && this.map.autosave.state !== "conflict") await this.map.autosave.close();
    if (this.map) this.map.autosave.closed = true;
  }

  async #reload() {
    const path = this.map?.header.path ?? "";
    const { header, cells } = await fetchMap(this.context, path);
    if (this.map) this.map.autosave.closed = true;
    this.#take(header, cells, path, false);
  }

  /**
   * @param {import("./model.js").Header} header
   * @param {Uint8Array} cells
   * @param {string} name
   * @param {boolean} [fit]
   */
  #take(header, cells, name, fit = true) {
    this.map = new OpenMap(this.context, header, cells, name, {
      cells: (changed) => {
        this.tiles?.change(changed);
        this.view.request();
      },
      size: () => {
        this.#paint();
        if (this.map) this.view.window = windowOf(this.map.frame);
      },
      steps: () => this.show(),
      state: this.tell,
      kept: (path) => this.#kept(path),
      reload: () => this.#reload(),
    });
    this.measured = null;
    this.#paint();
    this.tell("saved", header.version === null ? "not a file yet" : "");
    this.pencil.step = Math.max(
      this.pencil.step && Number((Math.round(0.1 / header.resolution) * header.resolution).toPrecision(6)),
      this.pencil.step ? header.resolution : 0,
    );
    this.view.step = this.pencil.step;
    if (header.path) this.context.navigate("map", { path: header.path }, true);
    if (fit) this.view.fit(windowOf(header));
    this.show();
  }

  /** @param {string} path */
  #kept(path) {
    this.context.navigate("map", { path }, true);
    const loose = this.furniture.file === null && this.furniture.pieces.length > 0;
    void this.trying(() => (loose ? this.furniture.create(path, scenarioName(path)) : this.furniture.load(path)));
    this.show();
  }

  #paint() {
    if (!this.map) return;
    const { values } = this.map.header;
    this.view.background = this.colours.faint;
    this.tiles = new Tiles(this.map.grid, coloursOf(values, this.colours), ranksOf(values));
  }

  /** @param {HTMLCanvasElement} canvas */
  #view(canvas) {
    const frame = () => this.map?.frame ?? null;
    return new View(canvas, [
      ground(() => (this.map && this.tiles ? { frame: this.map.frame, tiles: this.tiles } : null)),
      lattice(
        frame,
        () => this.pencil.step,
        () => this.colours.line,
      ),
      edges(frame, () => this.colours),
      { name: "furniture", draw: (context, view) => drawPieces(context, this.furniture, this.colours, view.pixel) },
      scaleBar(() => this.colours),
    ]);
  }

  /** @returns {import("../edit/tools.js").Tool[]} */
  #tools() {
    const desk = {
      map: () => this.map,
      pencil: this.pencil,
      colour: () => this.colours.accent,
      measured: (/** @type {number} */ metres, /** @type {number} */ cells) => {
        this.measured = { metres, cells };
        this.changed();
      },
    };
    const snap = (/** @type {import("../edit/tools.js").Hand} */ { point, alt }) =>
      this.map && !alt ? snapped(this.map.frame, point, this.pencil.step) : point;
    const tools = [
      walls(desk, { name: "wall", title: "Walls: drag, or click from corner to corner", key: "w" }, false),
      walls(desk, { name: "line", title: "Lines one cell thick", key: "l" }, true),
      box(desk),
      corners(desk),
      brush(desk, { name: "brush", title: "Paint", key: "b" }, null),
      brush(desk, { name: "erase", title: "Erase: paint free", key: "e" }, "free"),
      bucket(desk),
      mover(this.furniture, snap, () => this.colours.accent),
      extent(desk, (sides) => this.resize("crop or enlarge", sides)),
      ruler(desk),
      PAN,
    ];
    return tools.map((tool) => this.#pointed(tool));
  }

  /**
   * A tool that also tells where the pointer is.
   * @param {import("../edit/tools.js").Tool} tool
   * @returns {import("../edit/tools.js").Tool}
   */
  #pointed(tool) {
    const telling = (/** @type {"move" | "hover"} */ name) => (/** @type {import("../edit/tools.js").Hand} */ hand) => {
      this.#point(hand.point);
      tool[name]?.(hand);
    };
    return { ...tool, move: telling("move"), hover: telling("hover") };
  }

  /** @param {[number, number]} point */
  #point(point) {
    const { map } = this;
    if (!map) return;
    const [column, row] = toCells(map.frame, point).map(Math.floor);
    const code = map.grid.at(column, row);
    const kind = code < 0 ? "outside" : kindOf(map.header.values[code]);
    this.pointAt(`x ${point[0].toFixed(2)} m, y ${point[1].toFixed(2)} m · column ${column}, row ${row} · ${kind}`);
  }
}

/** The scenario file beside a map that has its furniture. @param {string} map */
export function scenarioName(map) {
  return map.replace(/\.ya?ml$/, "_furnished.json");
}

/** @param {HTMLElement} element @returns {Colours} */
function coloursOfPage(element) {
  const style = getComputedStyle(element);
  return /** @type {Colours} */ (
    Object.fromEntries(COLOURS.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]))
  );
}
