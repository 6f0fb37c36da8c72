// All runs below the project folder: filter, sort, compare, open, export.

import { button, choice, field, make, settled } from "studio/shell/forms.js";
import { SIZE, allow, read, sort, written } from "studio/results/asked.js";
import { comparison } from "studio/results/compare.js";
import { filters } from "studio/results/filters.js";
import { Picked, USUAL, episodeTable } from "studio/results/table.js";

const PAUSE = 200; // ms after the last key
const EVERY = 5000; // ms between two looks at what runs have written meanwhile

class ResultsPage {
  /** @param {HTMLElement} root @param {import("studio/shell/pages.js").Context} context */
  constructor(root, context) {
    this.root = root;
    this.context = context;
    this.asked = read(context.query);
    this.picked = new Picked();
    this.turn = 0;
    this.every = false;
    this.before = "";
    /** @type {any} */ this.shown = null;
    this.filters = make("aside", { className: "filters", "aria-label": "filters" });
    this.facts = make("p", { id: "facts", role: "status" }, "the runs are read …");
    this.troubles = make("div", { className: "troubles" });
    this.table = make("div", {
      className: "scroll episodes",
      tabIndex: 0,
      role: "region",
      "aria-label": "table of episodes",
    });
    this.pager = make("div", { className: "row pager" });
    this.compared = make("section", { className: "compared", hidden: true, "aria-label": "comparison" });
    this.beside = make(
      "a",
      { className: "button", target: "_blank", rel: "noopener", hidden: true },
      "open beside each other",
    );
  }

  layOut() {
    const search = make("input", {
      type: "search",
      value: this.asked.text,
      placeholder: "words: planner, world, scenario, outcome …",
    });
    const soon = settled(() => this.ask(this.asked), PAUSE);
    search.addEventListener("input", () => {
      this.asked = { ...this.asked, text: search.value, page: 0 }; // at once: buttons beside it ask for the same
      soon();
    });
    const all = make("input", { type: "checkbox" });
    all.addEventListener("change", () => {
      this.every = all.checked;
      this.draw();
    });
    const acts = [
      button("Compare planners", () => this.compare()),
      button("Report", () => this.report()),
      button("Export CSV", () => this.save()),
    ];
    const searched = field("look for", search);
    searched.classList.add("grow");
    const bar = make(
      "div",
      { className: "row end" },
      searched,
      make("label", { className: "row tick" }, all, "all columns"),
      ...acts,
    );
    const right = make(
      "div",
      { className: "found" },
      bar,
      this.troubles,
      make("div", { className: "row" }, this.facts, this.beside),
      this.compared,
      this.table,
      this.pager,
    );
    this.root.append(make("h1", {}, "Results"), make("div", { className: "browse" }, this.filters, right));
  }

  /** @param {import("studio/results/asked.js").Asked} asked */
  async ask(asked) {
    this.asked = asked;
    history.replaceState(null, "", `#/results${written(asked) ? `?${written(asked)}` : ""}`);
    await this.look();
  }

  /** Ask for the page of the table; what comes late, after another question, is dropped. */
  async look() {
    const turn = ++this.turn;
    try {
      const found = await this.context.api.post("/api/results/page", { ...this.asked, size: SIZE });
      if (turn !== this.turn) return;
      this.shown = found;
      const now = JSON.stringify([found, this.asked]);
      if (now !== this.before) this.draw();
      this.before = now;
    } catch (error) {
      if (turn === this.turn) this.wrong(error);
    }
  }

  draw() {
    if (!this.shown) return;
    const { total, rows, columns, counts, troubles, gone, summary } = this.shown;
    const focused = focusOf(this.root);
    const open = new Map([...this.filters.querySelectorAll("details")].map((one) => [one.dataset.column, one.open]));
    this.filters.replaceChildren(
      ...filters(counts, this.asked.allowed, (column, value, on) => this.ask(allow(this.asked, column, value, on))),
    );
    for (const one of this.filters.querySelectorAll("details")) one.open = open.get(one.dataset.column) ?? one.open;
    const names = this.every ? columns : USUAL.filter((name) => columns.includes(name));
    const sorted = (/** @type {string} */ column) => this.ask(sort(this.asked, column));
    const nothing = make(
      "p",
      { className: "soft empty" },
      Object.keys(this.asked.allowed).length || this.asked.text
        ? "No episode is like that."
        : "There is no run in this folder yet.",
    );
    this.table.replaceChildren(
      total ? episodeTable(names, rows, this.asked, sorted, this.picked, () => this.ticked()) : nothing,
    );
    this.facts.textContent = factsOf(total, summary);
    this.troubles.replaceChildren(...troublesOf(troubles, gone));
    this.page(total);
    focused();
  }

  /** @param {number} total */
  page(total) {
    const last = Math.max(0, Math.ceil(total / SIZE) - 1);
    const { page } = this.asked;
    const go = (/** @type {string} */ text, /** @type {number} */ to) =>
      button(text, () => this.ask({ ...this.asked, page: to }), { disabled: to < 0 || to > last || to === page });
    const where = make(
      "span",
      { className: "soft" },
      `page ${(page + 1).toLocaleString("en")} of ${(last + 1).toLocaleString("en")}`,
    );
    this.pager.replaceChildren(
      ...(last ? [go("first", 0), go("back", page - 1), where, go("on", page + 1), go("last", last)] : []),
    );
  }

  ticked() {
    const address = this.picked.address();
    const count = this.picked.rows.size;
    this.beside.hidden = count < 2;
    if (address) this.beside.href = address;
    else this.beside.removeAttribute("href");
    this.beside.textContent = address
      ? `open ${count} beside each other`
      : "episodes of one number alone can be opened beside each other";
  }

  async compare(baseline = "", all = false) {
    this.compared.hidden = false;
    this.compared.replaceChildren(make("p", { className: "soft" }, "comparing …"));
    try {
      const rows = await this.context.api.post("/api/results/compare", { ...this.asked, baseline });
      this.showCompared(rows, baseline, all);
    } catch (error) {
      this.compared.replaceChildren(
        make("p", { className: "bad" }, error instanceof Error ? error.message : String(error)),
      );
    }
  }

  /** @param {import("studio/results/compare.js").Compared[]} rows @param {string} baseline @param {boolean} all */
  showCompared(rows, baseline, all) {
    const planners = Object.keys(this.shown.counts.preset);
    const against = choice(["", ...planners], baseline, (value) => this.compare(value, all));
    against.options[0].text = "the first";
    const every = make("input", { type: "checkbox", checked: all });
    every.addEventListener("change", () => this.showCompared(rows, baseline, every.checked));
    const note =
      "Whole runs are compared: filters of planner, robot, world and run count, those of outcome choose runs that " +
      "have such an episode. * : chance does not explain it.";
    const close = button("close", () => (this.compared.hidden = true), { className: "quiet" });
    const head = make(
      "div",
      { className: "row end" },
      make("h2", { className: "grow" }, "Planners on the same scenarios"),
      field("against", against),
      make("label", { className: "row tick" }, every, "all metrics"),
      close,
    );
    this.compared.replaceChildren(head, comparison(rows, all), make("p", { className: "hint" }, note));
  }

  async report() {
    this.context.say("the report is written …");
    try {
      const { folder } = await this.context.api.post("/api/results/report", this.asked);
      this.context.say(`report: ${folder}`);
      window.open(`/report/${folder}`, "_blank", "noopener");
    } catch (error) {
      this.wrong(error);
    }
  }

  async save() {
    try {
      const content = await this.context.api.file("/api/results/export", this.asked);
      const address = URL.createObjectURL(content);
      make("a", { href: address, download: "episodes.csv" }).click();
      URL.revokeObjectURL(address);
      this.context.say(`${this.shown.total.toLocaleString("en")} episodes are in episodes.csv`);
    } catch (error) {
      this.wrong(error);
    }
  }

  /** @param {unknown} error */
  wrong(error) {
    this.context.say(error instanceof Error ? error.message : String(error), "error");
  }
}

/** @param {number} total @param {{preset: string, robot: string, episodes: number, succeeded: number}[]} summary */
function factsOf(total, summary) {
  const parts = summary
    .slice(0, 6)
    .map(({ preset, robot, episodes, succeeded }) => `${preset} on ${robot} ${succeeded} of ${episodes}`);
  const rest = summary.length > 6 ? ", …" : "";
  const succeeded = parts.length ? `; succeeded: ${parts.join(", ")}${rest}` : "";
  return `${total.toLocaleString("en")} episode${total === 1 ? "" : "s"}${succeeded}`;
}

/** @param {string[]} troubles @param {Record<string, number>} gone */
function troublesOf(troubles, gone) {
  const lost = Object.entries(gone).map(
    ([run, count]) => `${run}: the run is gone, with ${count} episodes that were shown before`,
  );
  return [...troubles, ...lost].slice(0, 10).map((text) => make("p", { className: "warn" }, text));
}

/**
 * Note what has the focus; the returned function gives it back to what stands in its place.
 * @param {HTMLElement} root
 */
function focusOf(root) {
  const active = /** @type {HTMLElement | null} */ (
    root.contains(document.activeElement) ? document.activeElement : null
  );
  const [column, value] = [active?.dataset.column ?? "", active?.dataset.value];
  const inside = /** @type {HTMLElement | null} */ (active?.closest("[data-column]"))?.dataset.column ?? "";
  return () => {
    if (!active || active.isConnected) return;
    const place =
      value === undefined
        ? `th [data-column="${CSS.escape(column)}"]`
        : `[data-column="${CSS.escape(inside)}"] [data-value="${CSS.escape(value)}"]`;
    /** @type {HTMLElement | null} */ (root.querySelector(place))?.focus();
  };
}

/** @type {import("studio/shell/pages.js").Page} */
export const page = {
  name: "results",
  title: "Results",
  async mount(root, context) {
    const shown = new ResultsPage(root, context);
    shown.layOut();
    await shown.look();
    const timer = setInterval(() => document.visibilityState === "visible" && shown.look(), EVERY);
    return () => clearInterval(timer);
  },
};
