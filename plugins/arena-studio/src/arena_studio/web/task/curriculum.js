// Curricula: a table of levels, a plot of each column, checked as one types and saved by itself.

import { Autosave } from "studio/edit/autosave.js";
import { latest } from "studio/edit/latest.js";
import { History } from "studio/edit/undo.js";
import { button, make, settled } from "studio/shell/forms.js";
import { keepRules } from "studio/task/keeping.js";
import { changed, COLUMNS, inserted, removed, shifted } from "studio/task/levels.js";
import { Parameters } from "studio/task/parameters.js";
import { plots } from "studio/task/plot.js";

/** @typedef {import("./levels.js").Level} Level */
/** @typedef {{level: number, key: string, line: string}} Finding */

// parameters of task=random that levels state
const STATED = ["task.pedestrians", "task.obstacles.count", "task.people.speed"];

const SAID = /** @type {Record<string, string>} */ ({
  saved: "saved",
  changed: "…",
  saving: "saving …",
  away: "not saved: the studio does not answer; trying again",
  refused: "not saved",
  conflict: "conflict: not saved",
});

export class CurriculumPart {
  /** @param {import("../shell/pages.js").Context} context */
  constructor(context) {
    this.context = context;
    this.path = "";
    /** @type {Level[]} */ this.levels = [];
    /** @type {Finding[]} */ this.findings = [];
    this.history = new History(() => this.#stepped());
    /** @type {Autosave | null} */ this.autosave = null;
    this.checkSoon = settled(() => void this.check(), 250);
    this.turn = 0;
    this.opening = latest();
    this.files = make("select", { "aria-label": "curriculum" });
    this.files.addEventListener("change", () => void this.trying(() => this.open(this.files.value)));
    this.state = make("span", { className: "state soft", role: "status" });
    this.table = make("tbody");
    this.plots = make("div", { className: "plots" });
    this.wrong = make("ul", { className: "wrong", "aria-live": "polite" });
    this.command = make("code", {});
    this.moves = new Parameters(() => this.#said()); // from level to level
    this.rest = new Parameters(() => this.#said()); // what levels leave open
    this.undo = button("↶", () => this.history.undo(), { "aria-label": "undo", title: "undo (Ctrl+Z)" });
    this.redo = button("↷", () => this.history.redo(), { "aria-label": "redo", title: "redo (Ctrl+Y)" });
    this.body = make(
      "div",
      { className: "stack", hidden: true },
      this.wrong,
      this.#table(),
      button("Add a level", () => this.change("add a level", inserted(this.levels, this.levels.length))),
      this.plots,
      this.#more(),
      make("p", { className: "soft" }, "run it: ", this.command),
    );
    this.element = make(
      "div",
      { className: "stack" },
      make(
        "div",
        { className: "row" },
        make("label", { className: "inline" }, "curriculum ", this.files),
        this.undo,
        this.redo,
        this.state,
      ),
      this.body,
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
    const found = await this.context.api.get("/api/curricula");
    this.names = found.files.map((/** @type {any} */ row) => row.path);
    const mine = found.files.map(
      (/** @type {any} */ row) =>
        new Option(row.error ? `${row.path} (cannot be read)` : `${row.path} (${row.levels} levels)`, row.path),
    );
    const given = found.built_in.map(
      (/** @type {any} */ row) => new Option(`${row.path}, comes with the suite (${row.levels} levels)`, row.path),
    );
    this.files.replaceChildren(new Option("choose a curriculum", ""), ...mine, ...given, new Option("a new one", "*"));
    this.files.value = this.path;
    const form = async (/** @type {string} */ option) =>
      (await this.context.api.get(`/api/run/form?group=task&option=${option}`)).fields;
    const [staged, random] = await Promise.all(["staged", "random"].map(form));
    this.moves.show(
      staged.filter((/** @type {import("./parameters.js").Field} */ { key }) => key !== "task.path"),
      "from level to level",
    );
    const open = random.filter((/** @type {import("./parameters.js").Field} */ { key }) => !STATED.includes(key));
    this.rest.show(
      open.map((/** @type {import("./parameters.js").Field} */ one) => ({
        ...one,
        key: one.key.replace("task.", "task.random."),
      })),
      "random",
    );
  }

  /** How a run goes from level to level, and what the levels leave open. */
  #more() {
    const keep = button(
      "Keep as an option …",
      () =>
        void this.trying(() =>
          keepRules(this.context, "staged", { path: this.path, ...this.moves.rules, ...this.rest.rules }),
        ),
      { title: "as an option task=NAME of this project" },
    );
    const open = make("details", {}, make("summary", {}, "What the levels leave open"), this.rest.element);
    return make("div", { className: "stack more" }, this.moves.element, open, keep);
  }

  #said() {
    this.command.textContent = [
      "arena run task=staged",
      `task.path=${this.path}`,
      ...this.moves.words,
      ...this.rest.words,
      "planner=dwa world=indoor episodes=240",
    ].join(" ");
  }

  /** @param {string} name a file, one that comes with the suite, or `*`: a new one */
  async open(name) {
    if (!name) return;
    const own = /\.ya?ml$/.test(name);
    const wanted = this.opening();
    const found =
      name === "*"
        ? { levels: inserted([], 0), version: null }
        : await this.context.api.get(`/api/curricula/file?path=${encodeURIComponent(name)}`);
    if (!wanted()) return;
    await this.close();
    this.path = own ? name : freePath(name === "*" ? "curriculum" : name, this.names ?? []);
    this.levels = found.levels;
    this.history.done = [];
    this.history.undone = [];
    this.autosave = new Autosave(this.#owner(), found.version);
    if (!own) this.context.say(`What you change is kept as ${this.path}`);
    this.state.textContent = own ? "saved" : "not a file yet";
    this.body.hidden = false;
    this.#name();
    this.show();
    await this.check();
  }

  #name() {
    if (![...this.files.options].some((option) => option.value === this.path))
      this.files.add(new Option(this.path, this.path));
    this.files.value = this.path;
    this.context.navigate("task", { part: "curriculum", path: this.path }, true);
  }

  /** @returns {import("../edit/autosave.js").Owner} */
  #owner() {
    return {
      save: async (version) =>
        (
          await this.context.api.put(`/api/curricula/file?path=${encodeURIComponent(this.path)}`, this.levels, {
            version,
          })
        ).version,
      theirs: () => this.open(this.path),
      copy: async () => {
        this.path = freePath(this.path.replace(/^curricula\//, "").replace(/\.ya?ml$/, ""), [
          ...(this.names ?? []),
          this.path,
        ]);
        this.autosave?.loaded(null);
        this.autosave?.change();
        this.#name();
      },
      tell: (state, said) => {
        this.state.textContent = `${SAID[state]}${said && state !== "away" ? `: ${said}` : ""}`;
        this.state.classList.toggle("bad", ["away", "refused", "conflict"].includes(state));
      },
      ask: this.context.ask,
    };
  }

  /** @param {string} label @param {Level[]} after */
  change(label, after) {
    const before = this.levels;
    if (after === before) return;
    this.history.run({ label, do: () => void (this.levels = after), undo: () => void (this.levels = before) });
  }

  #stepped() {
    if (!this.autosave) return;
    this.autosave.change();
    this.checkSoon();
    this.show();
  }

  async check() {
    const turn = ++this.turn;
    const { findings } = await this.context.api.post("/api/curricula/check", this.levels);
    if (turn !== this.turn) return;
    this.findings = findings;
    this.mark();
  }

  show() {
    [this.undo.disabled, this.redo.disabled] = [!this.history.canUndo, !this.history.canRedo];
    const active = document.activeElement instanceof HTMLElement ? document.activeElement.dataset.cell : undefined;
    this.table.replaceChildren(...this.levels.map((level, at) => this.#row(level, at)));
    if (active) /** @type {HTMLElement | null} */ (this.table.querySelector(`[data-cell="${active}"]`))?.focus();
    this.plots.replaceChildren(...plots(this.levels));
    this.#said();
    this.mark();
  }

  mark() {
    for (const input of this.table.querySelectorAll("input")) {
      const bad = this.findings.some(({ level, key }) => input.dataset.cell === `${level} ${key}`);
      input.toggleAttribute("aria-invalid", bad);
      if (bad) input.setAttribute("aria-invalid", "true");
    }
    this.wrong.replaceChildren(...this.findings.map(({ line }) => make("li", { className: "bad" }, line)));
  }

  #table() {
    const head = COLUMNS.map(({ title, unit, meaning }) =>
      make("th", { title: meaning, scope: "col" }, unit ? `${title} (${unit})` : title),
    );
    return make(
      "div",
      { className: "scroll" },
      make(
        "table",
        { className: "levels" },
        make("thead", {}, make("tr", {}, make("th", { scope: "col" }, "level"), ...head, make("td", {}))),
        this.table,
      ),
    );
  }

  /** @param {Level} level @param {number} at */
  #row(level, at) {
    const cells = COLUMNS.map((column) => make("td", {}, this.#input(level, at, column)));
    const act = (/** @type {string} */ text, /** @type {string} */ said, /** @type {() => Level[]} */ after) =>
      button(text, () => this.change(said, after()), {
        className: "quiet",
        "aria-label": `${said} ${at}`,
        title: said,
      });
    const acts = make(
      "td",
      { className: "acts" },
      act("↑", "raise level", () => shifted(this.levels, at, -1)),
      act("↓", "lower level", () => shifted(this.levels, at, 1)),
      act("+", "insert after level", () => inserted(this.levels, at + 1)),
      act("✕", "remove level", () => (this.levels.length > 1 ? removed(this.levels, at) : this.levels)),
    );
    return make("tr", {}, make("th", { scope: "row" }, String(at)), ...cells, acts);
  }

  /** @param {Level} level @param {number} at @param {import("./levels.js").Column} column */
  #input(level, at, { key, title, low, high, step, whole, empty }) {
    const value = level[key] ?? null;
    const input = make("input", {
      type: "number",
      step: whole ? "1" : "any",
      min: String(low),
      value: value === null ? "" : String(value),
      placeholder: empty,
      "aria-label": `${title} of level ${at}`,
      "data-cell": `${at} ${key}`,
    });
    if (high !== undefined) input.max = String(high);
    input.addEventListener("keydown", (event) => this.#arrow(event, input, step));
    input.addEventListener("change", () =>
      this.change(`change ${title}`, changed(this.levels, at, key, input.value === "" ? null : Number(input.value))),
    );
    return input;
  }

  /**
   * Up and down go to the level above and below; with Alt they change the number.
   * @param {KeyboardEvent} event
   * @param {HTMLInputElement} input
   * @param {number} step
   */
  #arrow(event, input, step) {
    const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (!way) return;
    event.preventDefault();
    if (event.altKey) {
      input.value = String(Math.round(1e6 * (Number(input.value || 0) + way * step)) / 1e6);
      return void input.dispatchEvent(new Event("change"));
    }
    const [at, key] = /** @type {string} */ (input.dataset.cell).split(" ");
    /** @type {HTMLElement | null} */ (this.table.querySelector(`[data-cell="${Number(at) - way} ${key}"]`))?.focus();
  }

  async close() {
    if (this.autosave && this.autosave.state !== "conflict") await this.autosave.close();
    if (this.autosave) this.autosave.closed = true;
  }
}

/** @param {string} stem @param {string[]} taken */
function freePath(stem, taken) {
  for (let number = 1; ; number++) {
    const path = `curricula/${stem}${number === 1 ? "" : `_${number}`}.yaml`;
    if (!taken.includes(path)) return path;
  }
}
