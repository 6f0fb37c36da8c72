// The canvas of the solid world: a pane for each world, drawn by three.js once that is there.

import { ground } from "arena/looks.js";
import { paneAt } from "arena/panes.js";
import { loadThree } from "arena/solid/loading.js";
import { World } from "arena/solid/world.js";

/** @typedef {import("../scene.js").Pane} Pane */

const SOFTWARE_RATIO = 0.75; // pixels that are drawn for one of the page

/** Colours of the ground and of what stands on it, for a light page or a dark one. @param {Element} element */
function coloursOf(element) {
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  const solid = dark
    ? { floor: "#7d8590", wall: "#c7ccd4", obstacle: "#b08a5b", sky: "#1c2127" }
    : { floor: "#e9e5dc", wall: "#f4f5f7", obstacle: "#b98d57", sky: "#dfe8f1" };
  return { ...ground(element), ...solid };
}

/** Return whether a processor draws here in place of a graphics card: it gets fewer pixels and no smooth edges. */
function drawsInSoftware() {
  const context = document.createElement("canvas").getContext("webgl2");
  const said = context?.getExtension("WEBGL_debug_renderer_info");
  return /swiftshader|llvmpipe|software|basic render/i.test(
    said ? String(context?.getParameter(said.UNMASKED_RENDERER_WEBGL)) : "",
  );
}

export class Stage {
  /** @param {HTMLCanvasElement} canvas @param {import("../episode.js").Episode[]} episodes */
  constructor(canvas, episodes) {
    this.canvas = canvas;
    this.episodes = episodes;
    /** @type {any} */ this.three = null;
    /** @type {any} */ this.renderer = null;
    /** @type {Map<string, World>} */ this.worlds = new Map();
    this.mode = "orbit";
    this.software = false;
  }

  /** Bring what draws; throw an Error with one line where this browser cannot. */
  async open() {
    if (this.renderer) return;
    this.three = await loadThree();
    this.software = drawsInSoftware();
    try {
      this.renderer = new this.three.WebGLRenderer({ canvas: this.canvas, antialias: !this.software });
    } catch {
      throw new Error("this browser draws nothing in three dimensions (no WebGL)");
    }
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = this.software ? this.three.BasicShadowMap : this.three.PCFShadowMap;
    this.renderer.setScissorTest(true);
  }

  /** Forget colours, after the page went dark or light. */
  recolour() {
    this.worlds.clear();
  }

  /** The world of a pane. @param {Pane} pane */
  world(pane) {
    const key = pane.shown.join();
    let found = this.worlds.get(key);
    if (!found) {
      const shown = pane.shown.map((number) => ({ number, episode: this.episodes[number] }));
      found = new World(this.three, shown, coloursOf(this.canvas), this.software ? 1024 : 2048);
      this.worlds.set(key, found);
    }
    found.eye.mode = this.mode;
    return found;
  }

  /**
   * @param {Pane[]} panes @param {number} time @param {import("../scene.js").Layers} layers
   * @param {number} ratio device pixels a CSS pixel
   */
  draw(panes, time, layers, ratio) {
    const { renderer, canvas } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    renderer.setPixelRatio(this.software ? SOFTWARE_RATIO : Math.min(ratio, 2));
    renderer.setSize(width, height, false);
    for (const pane of panes) {
      const world = this.world(pane);
      const below = height - pane.y - pane.height; // three.js counts from below
      renderer.setViewport(pane.x, below, pane.width, pane.height);
      renderer.setScissor(pane.x, below, pane.width, pane.height);
      world.draw(time, layers, pane.width / pane.height);
      renderer.render(world.scene, world.eye.camera);
    }
  }

  /** The eye of the pane under a pixel. @param {Pane[]} panes @param {number} x @param {number} y */
  eyeAt(panes, x, y) {
    return this.world(paneAt(panes, x, y)).eye;
  }
}
