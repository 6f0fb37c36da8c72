// The scenario editor's store: the open file, what is chosen in it, what is wrong with it, and its history.

import { Autosave } from "studio/edit/autosave.js";
import { latest } from "studio/edit/latest.js";
import { History } from "studio/edit/undo.js";
import { groundOf } from "studio/scenario/ground.js";
import { freeName, newContent, newScene, relativePath, valueOf, withScene } from "studio/scenario/model.js";
import { settled } from "studio/shell/forms.js";

/** @typedef {import("./model.js").Content} Content */
/** @typedef {import("./model.js").Scene} Scene */
/** @typedef {import("./model.js").Thing} Thing */
/** @typedef {{scene: number, key: string, place: [number, number] | null, line: string}} Finding */
/**
 * @typedef {{robot: string[], planner: string[], pedestrians: string[], world: string[], furniture: Record<string,
 * any[]>, behaviour: Record<string, any>}} Kinds
 */

const OURS = "arena-scenario";
const LATER = 350; // ms after the last change until it is checked

export class Editor {
  /**
   * @param {import("../shell/pages.js").Context} context
   * @param {Kinds} kinds
   * @param {(state: string, said: string) => void} tell how saving stands
   */
  constructor(context, kinds, tell) {
    this.context = context;
    this.kinds = kinds;
    this.tell = tell;
    /** @type {Set<() => void>} */ this.listeners = new Set();
    /** @type {Content | null} */ this.content = null;
    this.path = "";
    this.map = "";
    this.at = 0; // number of the scene that is shown
    /** @type {Thing | null} */ this.chosen = null;
    /** @type {import("./ground.js").Ground | null} */ this.ground = null;
    /** @type {Finding[]} */ this.findings = [];
    /** @type {"" | "checking" | "checked"} */ this.checking = "";
    this.robotName = "turtlebot3";
    this.people = "social_force";
    /** @type {any} */ this.robot = null; // its body, as it was checked for
    // the kind that the furniture tool places
    /** @type {string | undefined} */ this.piece = Object.keys(kinds.furniture)[0];
    this.snap = { step: 0.1, grid: true, free: true };
    this.history = new History(() => this.#changed());
    /** @type {Autosave | null} */ this.autosave = null;
    this.opening = latest();
    this.laying = latest();
    this.turn = 0; // number of the last check that was asked for
    this.checkSoon = settled(() => void this.check(), LATER);
    /** @type {Content | null} */ this.before = null; // the content when a drag began
  }

  /** The scene that is shown. @returns {Scene} */
  get scene() {
    return /** @type {Content} */ (this.content).scenarios[this.at];
  }

  /** @param {() => void} listener */
  listen(listener) {
    this.listeners.add(listener);
  }

  show() {
    for (const listener of this.listeners) listener();
  }

  /** Do what may fail, and say why it did. @param {() => Promise<unknown>} act */
  async trying(act) {
    try {
      await act();
    } catch (error) {
      this.context.say(error instanceof Error ? error.message : String(error), "error");
    }
  }

  /** Open a file of any format; one of another program goes on as a new file of ours. @param {string} path */
  async open(path) {
    const wanted = this.opening();
    const found = await this.context.api.get(`/api/scenarios/file?path=${encodeURIComponent(path)}`);
    if (!wanted()) return;
    await this.#leave();
    const ours = found.format === OURS;
    const own = ours ? path : newName(path.replace(/\.\w+$/, ""), await this.names());
    if (!ours)
      this.context.say(
        `${path} is in the format of ${found.format}; what you change is kept as ${own}` +
          (found.notes ? `. Read otherwise: ${found.notes}` : ""),
      );
    const content = ours || !found.map ? found.content : { ...found.content, map: relativePath(own, found.map) };
    await this.#take(own, content, found.map ?? "", ours ? found.version : null);
  }

  /** Begin a new file on a map. @param {string} path @param {string} map */
  async begin(path, map) {
    const wanted = this.opening();
    await this.#leave();
    await this.#take(path, newContent([newScene("scene 1")], map && relativePath(path, map)), map, null);
    const { middleOf } = await import("studio/scenario/placing.js");
    if (!wanted()) return;
    if (this.ground) {
      this.content = newContent([newScene("scene 1", middleOf(this.ground))], map && relativePath(path, map));
    }
    this.autosave?.change();
    this.show();
  }

  /** @param {string} path @param {Content} content @param {string} map @param {string | null} version */
  async #take(path, content, map, version) {
    Object.assign(this, {
      path,
      content,
      at: 0,
      chosen: null,
      findings: [],
      checking: "",
      robot: null,
      map: "",
      ground: null,
    });
    this.history.done = [];
    this.history.undone = [];
    this.autosave = new Autosave(this.#owner(), version);
    this.tell("saved", version === null ? "not a file yet" : "");
    this.context.navigate("scenario", { path }, true);
    await this.setMap(map, false);
    this.checkSoon();
  }

  /** @returns {import("../edit/autosave.js").Owner} */
  #owner() {
    const address = () => `/api/scenarios/file?path=${encodeURIComponent(this.path)}`;
    return {
      save: async (version) => (await this.context.api.put(address(), this.content, { version })).version,
      theirs: async () => this.open(this.path),
      copy: async () => {
        this.path = newName(`${this.path.replace(/(\.mine)?\.\w+$/, "")}.mine`, await this.names());
        this.autosave?.loaded(null);
        this.autosave?.change();
        this.context.navigate("scenario", { path: this.path }, true);
        this.show();
      },
      tell: this.tell,
      ask: this.context.ask,
    };
  }

  /** The names of all scenario files. @returns {Promise<string[]>} */
  async names() {
    return (await this.context.api.get("/api/scenarios")).map((/** @type {{path: string}} */ row) => row.path);
  }

  /**
   * Lay another map under the scenes.
   * @param {string} map relative to the project
   * @param {boolean} [keep] in the file, too
   */
  async setMap(map, keep = true) {
    const wanted = this.laying();
    const ground = map
      ? await groundOf(await this.context.api.get(`/api/scenarios/map?path=${encodeURIComponent(map)}`)).catch(
          (error) => this.#noMap(error),
        )
      : null;
    if (!wanted()) return;
    Object.assign(this, { ground, map: ground ? map : "" });
    if (keep && ground)
      this.#step("map", { .../** @type {Content} */ (this.content), map: relativePath(this.path, map) });
    this.show();
  }

  /** @param {Error} error @returns {null} */
  #noMap(error) {
    this.context.say(error.message, "error");
    return null;
  }

  /**
   * Change the scene that is shown, as one step that can be taken back.
   * @param {string} label
   * @param {(scene: Scene) => Scene} make
   */
  change(label, make) {
    if (!this.content) return;
    const scene = make(this.scene);
    if (scene !== this.scene) this.#step(label, withScene(this.content, this.at, scene));
  }

  /**
   * Change the file as a whole.
   * @param {string} label
   * @param {(content: Content) => Content} make
   * @param {number} [at] the scene to show
   */
  changeFile(label, make, at = this.at) {
    if (this.content) this.#step(label, make(this.content), at);
  }

  /** Show a change while something is dragged; `drop` makes it a step. @param {Scene} scene */
  drag(scene) {
    if (!this.content) return;
    this.before ??= this.content;
    this.content = withScene(this.content, this.at, scene);
    this.show();
  }

  /** @param {string} label */
  drop(label) {
    const [before, after] = [this.before, this.content];
    this.before = null;
    if (!before || !after || before === after) return;
    this.content = before;
    this.#step(label, after);
  }

  /** Take back what was dragged. */
  cancel() {
    if (this.before) this.content = this.before;
    this.before = null;
    this.show();
  }

  /** @param {string} label @param {Content} after @param {number} [at] */
  #step(label, after, at = this.at) {
    const before = { content: /** @type {Content} */ (this.content), at: this.at };
    this.history.run({ label, do: () => this.#put(after, at), undo: () => this.#put(before.content, before.at) });
  }

  /** @param {Content} content @param {number} at */
  #put(content, at) {
    this.content = content;
    this.at = Math.min(at, content.scenarios.length - 1);
    if (this.chosen && valueOf(this.scene, this.chosen) === undefined) this.chosen = null;
  }

  #changed() {
    if (!this.content || !this.autosave) return;
    this.autosave.change();
    this.turn++; // what is being checked is no longer what is shown
    this.checking = "";
    this.checkSoon();
    this.show();
  }

  /** @param {Thing | null} thing */
  choose(thing) {
    this.chosen = thing;
    this.show();
  }

  /** Show another scene. @param {number} at */
  turnTo(at) {
    Object.assign(this, { at, chosen: null });
    this.show();
  }

  /** Add a scene, a copy of the one that is shown or an empty one. @param {boolean} copy */
  addScene(copy) {
    const names = /** @type {Content} */ (this.content).scenarios.map(({ name }) => name);
    const scene = copy
      ? { ...this.scene, name: freeName(this.scene.name, names) }
      : { ...newScene(freeName("scene 1", names)), start: this.scene.start, goal: this.scene.goal };
    this.changeFile(
      "add a scene",
      (content) => ({ ...content, scenarios: [...content.scenarios, scene] }),
      names.length,
    );
  }

  removeScene() {
    this.changeFile(
      "remove a scene",
      (content) => ({ ...content, scenarios: content.scenarios.filter((_, at) => at !== this.at) }),
      Math.max(this.at - 1, 0),
    );
  }

  /** What requests about the content as it is now hand on. */
  get asked() {
    return { path: this.path, content: this.content, map: this.map, robot: this.robotName, pedestrians: this.people };
  }

  /** Ask what is wrong; an answer that is older than another question is dropped. */
  async check() {
    if (!this.content) return;
    const turn = ++this.turn;
    this.checking = "checking";
    this.show();
    let done = false;
    await this.trying(async () => {
      const { findings, robot } = await this.context.api.post("/api/scenarios/check", this.asked);
      if (turn !== this.turn) return;
      this.findings = findings;
      this.robot = robot ?? this.robot;
      done = true;
    });
    if (turn === this.turn) this.checking = done ? "checked" : "";
    this.show();
  }

  async #leave() {
    if (this.autosave && this.autosave.state !== "conflict") await this.autosave.close();
    if (this.autosave) this.autosave.closed = true;
  }

  /** Save what is left and let go. */
  async close() {
    this.listeners.clear();
    await this.#leave();
  }
}

/** `stem.json`, or with a number what is not taken yet. @param {string} stem @param {string[]} taken */
export function newName(stem, taken) {
  for (let number = 1; ; number++) {
    const name = `${stem}${number === 1 ? (taken.includes(`${stem}.json`) ? ".arena" : "") : `.${number}`}.json`;
    if (!taken.includes(name)) return name;
  }
}
