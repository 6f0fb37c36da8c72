// Rules of random problems: each parameter with unit, bounds and source, and what ten draws look like on their maps.

import { Camera } from "arena/camera.js";
import { drawFloor, pictureOf } from "arena/floor.js";
import { drawScene } from "studio/scenario/drawing.js";
import { groundOf, windowOf } from "studio/scenario/ground.js";
import { coloursOf } from "studio/scenario/looks.js";
import { newContent, relativePath } from "studio/scenario/model.js";
import { button, choice, make } from "studio/shell/forms.js";
import { keepRules } from "studio/task/keeping.js";
import { Parameters } from "studio/task/parameters.js";

const [WIDTH, HEIGHT] = [300, 220]; // CSS pixels of a draw

export class RulesPart {
  /** @param {import("../shell/pages.js").Context} context @param {any} kinds */
  constructor(context, kinds) {
    this.context = context;
    this.kinds = kinds;
    this.parameters = new Parameters(() => this.#said());
    this.world = "indoor";
    this.map = "";
    this.robot = "turtlebot3";
    this.seed = 0;
    /** @type {any} */ this.drawn = null;
    this.pictures = make("div", { className: "draws" });
    this.command = make("code", {});
    this.keep = button("Keep as a scenario file", () => void this.trying(() => this.kept()), {
      disabled: true,
      title: "the draws become scenes of a file; only on a map of the project",
    });
    this.draw = button("Draw ten", () => void this.trying(() => this.ask()), { className: "main" });
    this.places = make("select", { "aria-label": "world or map" });
    this.places.addEventListener("change", () => this.#place(this.places.value));
    this.element = make(
      "div",
      { className: "two" },
      make("div", { className: "stack" }, this.parameters.element),
      make(
        "div",
        { className: "stack" },
        this.#bar(),
        this.pictures,
        make("p", { className: "soft" }, "run it: ", this.command),
      ),
    );
  }

  /** @param {() => Promise<unknown>} act */
  async trying(act) {
    try {
      await act();
    } catch (error) {
      this.context.say(error instanceof Error ? error.message : String(error), "error");
    }
  }

  async load() {
    const [form, found] = await Promise.all([
      this.context.api.get("/api/run/form?group=task&option=random"),
      this.context.api.get("/api/maps"),
    ]);
    const maps = found.maps.filter((/** @type {string} */ name) => /\.ya?ml$/.test(name));
    const worlds = this.kinds.world.filter(
      (/** @type {string} */ name) => !["ros_map", "scenario_map", "file", "barn", "dynabarn"].includes(name),
    );
    this.places.replaceChildren(
      ...maps.map((/** @type {string} */ name) => new Option(`map ${name}`, `map:${name}`)),
      ...worlds.map((/** @type {string} */ name) => new Option(`world=${name}`, name)),
    );
    this.places.value = maps.length ? `map:${maps[0]}` : this.world;
    this.#place(this.places.value);
    this.parameters.show(form.fields, "the problem");
  }

  /** @param {string} value */
  #place(value) {
    [this.map, this.world] = value.startsWith("map:") ? [value.slice(4), "indoor"] : ["", value];
    this.#said();
  }

  #bar() {
    const seed = make("input", { type: "number", min: "0", step: "1", value: "0", className: "short" });
    seed.addEventListener("change", () => void (this.seed = Math.max(0, Math.floor(Number(seed.value)))));
    const robot = choice(this.kinds.robot, this.robot, (value) => {
      this.robot = value;
      this.#said();
    });
    const save = button(
      "Keep the rules …",
      () => void this.trying(() => keepRules(this.context, "random", this.parameters.rules)),
      { title: "as an option task=NAME of this project" },
    );
    return make(
      "div",
      { className: "row" },
      this.draw,
      make("label", { className: "inline" }, "in ", this.places),
      make("label", { className: "inline" }, "robot ", robot),
      make("label", { className: "inline" }, "seed ", seed),
      this.keep,
      save,
    );
  }

  #said() {
    const place = this.map ? `world=ros_map world.path=${this.map}` : `world=${this.world}`;
    this.command.textContent = [
      "arena run task=random",
      ...this.parameters.words,
      place,
      `robot=${this.robot} planner=dwa`,
    ].join(" ");
  }

  async ask() {
    this.draw.disabled = true;
    this.pictures.replaceChildren(make("p", { className: "soft" }, "drawing …"));
    try {
      const asked = {
        rules: this.parameters.rules,
        world: this.world,
        map: this.map,
        robot: this.robot,
        seed: this.seed,
        count: 10,
      };
      this.drawn = { ...(await this.context.api.post("/api/curricula/draws", asked)), asked };
      await this.show();
    } catch (error) {
      this.pictures.replaceChildren();
      throw error;
    } finally {
      this.draw.disabled = false;
    }
  }

  async show() {
    const { maps, draws, asked } = this.drawn;
    const grounds = await Promise.all(maps.map(groundOf));
    const colours = coloursOf(this.element);
    const pictures = grounds.map((ground) =>
      pictureOf(ground.cells, ground.width, ground.height, [colours.free, colours.wall, colours.unknown]),
    );
    this.pictures.replaceChildren(
      ...draws.map((/** @type {any} */ one, /** @type {number} */ at) =>
        this.#draw(one, at, grounds[one.map], pictures[one.map], colours),
      ),
    );
    this.keep.disabled = !asked.map || !draws.some((/** @type {any} */ one) => one.scene);
  }

  /**
   * @param {any} one
   * @param {number} at
   * @param {import("../scenario/ground.js").Ground} ground
   * @param {HTMLCanvasElement} picture
   * @param {import("../scenario/looks.js").Colours} colours
   */
  #draw(one, at, ground, picture, colours) {
    if (one.error)
      return make("figure", {}, make("p", { className: "bad" }, one.error), make("figcaption", {}, `draw ${at}`));
    const { scene } = one;
    const distance = Math.hypot(scene.goal[0] - scene.start[0], scene.goal[1] - scene.start[1]).toFixed(1);
    const said = `${scene.pedestrians.length} people, ${scene.obstacles.length} obstacles, ${distance} m`;
    const canvas = make("canvas", { role: "img", "aria-label": `draw ${at}: ${said}` });
    const ratio = devicePixelRatio || 1;
    [canvas.width, canvas.height] = [WIDTH * ratio, HEIGHT * ratio];
    const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    context.fillStyle = colours.unknown;
    context.fillRect(0, 0, canvas.width, canvas.height);
    const camera = new Camera();
    camera.fit(windowOf(ground), WIDTH, HEIGHT);
    camera.apply(context, { x: 0, y: 0, width: WIDTH, height: HEIGHT }, ratio);
    drawFloor(context, ground, picture);
    drawScene(
      context,
      { scene, chosen: null, findings: [], at: 0 },
      { colours, pixel: 1 / camera.scale, furniture: this.kinds.furniture, robot: null, goalRadius: 0.3 },
    );
    return make("figure", {}, canvas, make("figcaption", {}, `${at}: ${said}`));
  }

  async kept() {
    const { draws, asked } = this.drawn;
    const rows = await this.context.api.get("/api/scenarios");
    const taken = rows.map((/** @type {any} */ row) => row.path);
    const path = [1, ...Array.from({ length: 999 }, (_, at) => at + 2)]
      .map((number) => `scenarios/random${number === 1 ? "" : `_${number}`}.json`)
      .find((name) => !taken.includes(name));
    const scenes = draws.filter((/** @type {any} */ one) => one.scene).map((/** @type {any} */ one) => one.scene);
    const content = newContent(
      scenes,
      relativePath(/** @type {string} */ (path), asked.map),
      `Random problems of seed ${asked.seed}`,
    );
    await this.context.api.put(
      `/api/scenarios/file?path=${encodeURIComponent(/** @type {string} */ (path))}`,
      content,
      { version: null },
    );
    this.context.say(`written: ${path}`);
    this.context.navigate("scenario", { path: /** @type {string} */ (path) });
  }
}
