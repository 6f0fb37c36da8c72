// Compose an experiment from what is installed, start it, and watch it.

import { button, field, make, settled } from "studio/shell/forms.js";
import { Experiments } from "studio/run/experiments.js";
import { chooser, titleOf } from "studio/run/groups.js";
import { listen } from "studio/run/live.js";
import { parameterFields, showHeld } from "studio/run/parameters.js";
import { change, choose, nothing, ofScenario, restored } from "studio/run/wanted.js";

const KEPT = "arena-studio-run"; // in this tab, so that a reload loses nothing
const PAUSE = 350; // ms after the last change until it is composed

/** @typedef {import("studio/run/groups.js").Group} Group */
/** @typedef {import("studio/run/parameters.js").Parameter} Parameter */

class RunPage {
  /** @param {HTMLElement} root @param {import("studio/shell/pages.js").Context} context */
  constructor(root, context) {
    this.root = root;
    this.context = context;
    this.wanted = restored(sessionStorage.getItem(KEPT));
    /** @type {Record<string, string>} */ this.held = {};
    this.turn = 0;
    this.checked = false; // whether what is wanted now is being composed, or was
    this.starting = false;
    this.form = make("form", { className: "experiment-form", "aria-label": "experiment" });
    this.form.addEventListener("submit", (event) => event.preventDefault());
    this.command = make("output", { className: "code", id: "command" });
    this.verdict = make("p", { className: "soft", id: "verdict", role: "status" });
    this.starter = button("Start", () => this.start(), { className: "main", disabled: true });
    /** @type {Promise<void>} */ this.composing = Promise.resolve();
    this.list = make("div", { className: "experiments" });
    this.experiments = new Experiments(this.list, (name, act) => this.act(name, act));
    this.compose = settled(() => void (this.checked || this.check()), PAUSE);
  }

  async show() {
    this.takeScenario(this.context.query);
    this.layOut();
    const { api } = this.context;
    const [groups, settings] = await Promise.all([api.get("/api/run/groups"), api.get("/api/run/settings")]);
    this.fill(groups, settings.fields);
    await this.check();
  }

  /**
   * Take a scenario file that another page names, once: a reload brings back what was changed since.
   * @param {URLSearchParams} query
   */
  takeScenario(query) {
    const path = query.get("scenario");
    if (!path) return;
    this.wanted = ofScenario(this.wanted, path, query.get("map") ?? "", query.get("scenes") ?? "");
    sessionStorage.setItem(KEPT, JSON.stringify(this.wanted));
    this.context.navigate("run", {}, true);
  }

  layOut() {
    const again = button("Begin again", () => this.restart(), { className: "quiet" });
    const start = make(
      "section",
      { className: "panel start", "aria-label": "start" },
      make("h2", {}, "Command line"),
      make("div", { className: "row" }, this.starter, again),
      this.verdict,
      this.command,
    );
    const under = make(
      "section",
      { className: "under", "aria-label": "experiments" },
      make("h2", {}, "Experiments"),
      this.list,
    );
    this.root.append(make("h1", {}, "Run an experiment"), make("div", { className: "two" }, start, this.form, under));
  }

  /** @param {Group[]} groups @param {Parameter[]} settings */
  fill(groups, settings) {
    const offered = groups.filter((group) => group.options.length);
    const main = offered.filter((group) => group.first).map((group) => this.group(group));
    const others = offered.filter((group) => !group.first).map((group) => this.group(group));
    const more = make("input", {
      type: "text",
      value: this.wanted.more,
      placeholder: "KEY=VALUE …",
      autocomplete: "off",
      spellcheck: false,
    });
    more.addEventListener("input", () => this.set({ ...this.wanted, more: more.value }));
    const folder = make("input", {
      type: "text",
      value: this.wanted.folder,
      placeholder: "outputs/DATE/TIME",
      autocomplete: "off",
      spellcheck: false,
    });
    folder.addEventListener("input", () => this.set({ ...this.wanted, folder: folder.value }));
    this.form.replaceChildren(
      make("div", { className: "groups" }, ...main),
      this.folded("Episodes, seed and timing", settings, true),
      make(
        "details",
        {},
        make("summary", {}, "Other parts of the robot and the run"),
        make("div", { className: "groups" }, ...others),
      ),
      make(
        "div",
        { className: "grid" },
        field("more words of the command line", more),
        field("folder of the run", folder),
      ),
    );
  }

  /** @param {Group} group */
  group(group) {
    const parameters = make("div");
    const show = () =>
      parameters.replaceChildren(...this.options(group).map((option) => this.parameters(group, option)));
    const choice = chooser(group, this.wanted.choices[group.name] ?? [], (options) => {
      this.set(choose(this.wanted, group.name, options));
      show();
    });
    show();
    return make("div", { className: "group" }, choice, parameters);
  }

  /**
   * The options whose parameters can be changed: one alone, as those of a sweep have different ones.
   * @param {Group} group
   */
  options(group) {
    const chosen = this.wanted.choices[group.name] ?? group.chosen.split(",");
    return chosen.filter((option) => chosen.length === 1 && group.options.some(({ name }) => name === option));
  }

  /** Parameters, asked for when they are unfolded. @param {Group} group @param {string} option */
  parameters(group, option) {
    const place = make("div", { className: "grid" });
    const details = make(
      "details",
      { className: "parameters" },
      make("summary", { "aria-label": `${titleOf(group.name)} ${option}: parameters` }, "parameters"),
      place,
    );
    const changed = Object.keys(this.wanted.values).some((key) => key.startsWith(`${group.name}.`));
    details.addEventListener("toggle", async () => {
      if (!details.open || place.children.length) return;
      try {
        const form = await this.context.api.get(`/api/run/form?${new URLSearchParams({ group: group.name, option })}`);
        this.fields(place, form.fields, group.name);
      } catch (error) {
        this.wrong(error);
      }
    });
    details.open = changed;
    return details;
  }

  /** @param {string} title @param {Parameter[]} fields @param {boolean} open */
  folded(title, fields, open) {
    const place = make("div", { className: "grid" });
    this.fields(
      place,
      fields.filter(({ key }) => key !== "resume"),
      "",
    );
    return make("details", { open }, make("summary", {}, title), place);
  }

  /** @param {HTMLElement} place @param {Parameter[]} fields @param {string} inside */
  fields(place, fields, inside) {
    const given = (/** @type {string} */ key) => this.wanted.values[key] ?? "";
    const shown = parameterFields(inside, fields, given, (key, text) => this.set(change(this.wanted, key, text)));
    place.replaceChildren(...(shown.length ? shown : [make("p", { className: "soft" }, "It has none.")]));
    showHeld(place, this.held);
  }

  /** @param {import("studio/run/wanted.js").Wanted} wanted */
  set(wanted) {
    this.wanted = wanted;
    sessionStorage.setItem(KEPT, JSON.stringify(wanted));
    this.allow(true); // it checks what it starts, and must not be lost to a change that the click itself has made
    this.turn++;
    this.checked = false;
    this.checking(); // what is said and shown was said of something else
    this.compose();
  }

  /** @param {boolean} allowed what is wrong can be pressed, too: it then says why nothing starts */
  allow(allowed) {
    this.starter.disabled = false;
    this.starter.setAttribute("aria-disabled", String(!allowed));
  }

  checking() {
    this.verdict.className = "soft";
    this.verdict.textContent = "checking …";
  }

  check() {
    return (this.composing = this.composed());
  }

  async composed() {
    const turn = ++this.turn;
    this.checked = true;
    this.checking();
    try {
      const { command, jobs, episodes, values } = await this.context.api.post("/api/run/compose", this.wanted);
      if (turn !== this.turn) return;
      this.command.textContent = command;
      this.held = values;
      showHeld(this.form, values);
      const inJobs = jobs > 1 ? ` in ${jobs} jobs` : "";
      this.verdict.textContent = `${episodes} episode${episodes === 1 ? "" : "s"}${inJobs}; every value is allowed`;
      this.allow(true);
    } catch (error) {
      if (turn !== this.turn) return;
      this.verdict.className = "bad";
      this.verdict.textContent = error instanceof Error ? error.message : String(error);
      this.allow(false);
    }
  }

  async start() {
    if (this.starting) return;
    this.starting = true;
    try {
      await (this.checked ? this.composing : this.check());
      if (this.starter.getAttribute("aria-disabled") === "true")
        return this.context.say(this.verdict.textContent ?? "", "error");
      const started = await this.context.api.post("/api/run/start", this.wanted);
      this.context.say(`started: ${started.folder}`);
      this.list.scrollIntoView({ block: "nearest" });
    } catch (error) {
      this.wrong(error);
    } finally {
      this.starting = false;
    }
  }

  /** @param {string} name @param {"stop" | "resume" | "forget"} act */
  async act(name, act) {
    try {
      await this.context.api.post(`/api/run/experiments/${name}/${act}`, null);
      if (act === "stop") this.context.say("episodes under way end at their next step; finished ones are kept");
    } catch (error) {
      this.wrong(error);
    }
  }

  restart() {
    this.set(nothing());
    this.context.navigate("run");
  }

  /** @param {unknown} error */
  wrong(error) {
    this.context.say(error instanceof Error ? error.message : String(error), "error");
  }
}

/** @type {import("studio/shell/pages.js").Page} */
export const page = {
  name: "run",
  title: "Run",
  async mount(root, context) {
    const shown = new RunPage(root, context);
    const link = document.getElementById("link");
    const end = listen(
      (experiments) => shown.experiments.show(experiments),
      (connected) => link && (link.textContent = connected ? "" : "no connection to the studio"),
    );
    try {
      await shown.show();
    } catch (error) {
      shown.wrong(error);
    }
    return end;
  },
};
