// Scenario packs: what the project has, what is in them, and one made of chosen files.

import { button, field, make } from "studio/shell/forms.js";

export class PacksPart {
  /** @param {import("../shell/pages.js").Context} context */
  constructor(context) {
    this.context = context;
    this.list = make("div", { className: "stack" });
    this.files = make("div", { className: "files", role: "group", "aria-label": "files of the pack" });
    this.said = {
      folder: text("packs/mine"),
      id: text("mine"),
      version: text("1.0.0"),
      title: text(""),
      licence: text("none"),
    };
    const fields = Object.entries(this.said).map(([name, input]) => field(name, input));
    const make_one = button("Make the pack", () => void this.trying(() => this.make()), { className: "main" });
    this.element = make(
      "div",
      { className: "two packs" },
      make("div", { className: "stack" }, make("h2", {}, "Packs of this project"), this.list),
      make(
        "div",
        { className: "stack panel" },
        make("h2", {}, "Make one"),
        make(
          "p",
          { className: "soft" },
          "Scenario files and the maps that they name are copied below its folder; a run then takes " +
            "scenario=ID/NAME, and refuses files that have changed.",
        ),
        this.files,
        make("div", { className: "pair" }, ...fields),
        make_one,
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
    const [packs, files] = await Promise.all([
      this.context.api.get("/api/curricula/packs"),
      this.context.api.get("/api/scenarios"),
    ]);
    this.list.replaceChildren(
      ...(packs.length ? packs.map(packOf) : [make("p", { className: "soft" }, "There is none.")]),
    );
    const folders = packs.map((/** @type {any} */ pack) => `${pack.folder}/`);
    const free = files.filter(
      (/** @type {any} */ row) =>
        !row.error && !folders.some((/** @type {string} */ folder) => row.path.startsWith(folder)),
    );
    this.files.replaceChildren(
      ...(free.length
        ? free.map(fileBox)
        : [make("p", { className: "soft" }, "There is no scenario file outside packs.")]),
    );
  }

  async make() {
    const chosen = [.../** @type {NodeListOf<HTMLInputElement>} */ (this.files.querySelectorAll("input:checked"))].map(
      (box) => box.value,
    );
    if (!chosen.length) return this.context.say("Choose one file or more for the pack.", "error");
    const said = Object.fromEntries(Object.entries(this.said).map(([name, input]) => [name, input.value.trim()]));
    const made = await this.context.api.post("/api/curricula/packs", { ...said, files: chosen });
    this.context.say(`${made.folder}: ${made.options.join(", ")}`);
    return this.load();
  }

  async close() {}
}

/** @param {string} value */
function text(value) {
  return make("input", { type: "text", value });
}

/** @param {any} row */
function fileBox(row) {
  const box = make("input", { type: "checkbox", value: row.path });
  if (!row.map) box.disabled = true;
  const more = row.map ? `${row.scenes} ${row.scenes === 1 ? "scene" : "scenes"}` : "names no map of this project";
  return make("label", { className: "inline" }, box, ` ${row.path} `, make("span", { className: "soft" }, more));
}

/** @param {any} pack */
function packOf(pack) {
  const rows = (pack.scenarios ?? []).map((/** @type {any} */ row) =>
    make(
      "tr",
      {},
      make(
        "td",
        {},
        make("a", { href: `#/scenario?path=${encodeURIComponent(`${pack.folder}/${row.name}`)}` }, row.name),
      ),
      make("td", { className: "number" }, String(row.scenes)),
      make("td", {}, row.title),
    ),
  );
  const head = make(
    "p",
    {},
    make("b", {}, pack.id ?? pack.folder),
    ` ${pack.version ?? ""} in ${pack.folder}. ${pack.title ?? ""}`,
  );
  if (pack.error) head.append(" ", make("span", { className: "bad" }, pack.error));
  const table = make(
    "div",
    { className: "scroll" },
    make(
      "table",
      {},
      make(
        "thead",
        {},
        make("tr", {}, ...["file", "scenes", "title"].map((name) => make("th", { scope: "col" }, name))),
      ),
      make("tbody", {}, ...rows),
    ),
  );
  return make(
    "details",
    { className: "panel", open: true },
    make("summary", {}, pack.id ?? pack.folder),
    head,
    ...(rows.length ? [table] : []),
  );
}
