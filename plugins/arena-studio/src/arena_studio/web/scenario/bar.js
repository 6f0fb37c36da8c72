// The bars over the map: files, maps, history, export; and the scenes of a file as tabs.

import { newName } from "studio/scenario/editor.js";
import { button, choice, make } from "studio/shell/forms.js";

/** @typedef {import("./editor.js").Editor} Editor */

const FORMATS = ["arena-tools", "arena-rosnav"];

/** @param {Editor} editor @param {HTMLElement} state how saving stands */
export function fileBar(editor, state) {
  const files = make("select", { "aria-label": "scenario file" });
  const maps = make("select", { "aria-label": "map" });
  const [undo, redo] = [
    button("↶", () => editor.history.undo(), { "aria-label": "undo", title: "undo (Ctrl+Z)" }),
    button("↷", () => editor.history.redo(), { "aria-label": "redo", title: "redo (Ctrl+Y)" }),
  ];
  files.addEventListener("change", () => void editor.trying(() => editor.open(files.value)));
  maps.addEventListener("change", () => void editor.trying(() => editor.setMap(maps.value)));
  const names = () => [...files.options].map((option) => option.value).filter(Boolean);
  const fresh = button(
    "New",
    () => void editor.trying(() => editor.begin(newName(nextTo(maps.value), names()), maps.value)),
    { title: "a new file on the map that is chosen" },
  );
  const run = button("Run", () => void editor.trying(() => driven(editor)), {
    title: "the page Run, with the scenes of this file on this map",
  });
  const out = button("Export …", () => void editor.trying(() => exported(editor)));
  const element = make(
    "div",
    { className: "top row", role: "toolbar", "aria-label": "file" },
    make("label", { className: "inline" }, "file ", files),
    make("label", { className: "inline" }, "map ", maps),
    fresh,
    run,
    out,
    undo,
    redo,
    ...snapping(editor),
    make("span", { className: "standing" }, state),
  );
  return {
    element,
    async load() {
      const [rows, found] = await Promise.all([
        editor.context.api.get("/api/scenarios"),
        editor.context.api.get("/api/maps"),
      ]);
      fill(
        files,
        rows.map((/** @type {any} */ row) => [
          row.path,
          row.error ? `${row.path} (cannot be read)` : `${row.path} (${row.scenes})`,
        ]),
        "choose a file",
        editor.path,
      );
      const usable = found.maps.filter((/** @type {string} */ name) => /\.ya?ml$/.test(name));
      fill(
        maps,
        usable.map((/** @type {string} */ name) => [name, name]),
        "no map",
        editor.map,
      );
      return rows;
    },
    show() {
      [undo.disabled, redo.disabled] = [!editor.history.canUndo, !editor.history.canRedo];
      for (const each of [run, out]) each.disabled = !editor.content;
      put(files, editor.path);
      put(maps, editor.map);
    },
  };
}

/** @param {string} map */
function nextTo(map) {
  const place = map.replace(/\/?map\.ya?ml$/, "").replace(/\.ya?ml$/, "");
  return `scenarios/${place.split("/").at(-1) || "scene"}`;
}

/** @param {HTMLSelectElement} select @param {string[][]} rows @param {string} empty @param {string} value */
function fill(select, rows, empty, value) {
  select.replaceChildren(new Option(empty, ""), ...rows.map(([path, text]) => new Option(text, path)));
  put(select, value);
}

/** @param {HTMLSelectElement} select @param {string} value */
function put(select, value) {
  if (value && ![...select.options].some((option) => option.value === value)) select.add(new Option(value, value));
  select.value = value;
}

/** @param {Editor} editor */
function snapping(editor) {
  const box = (/** @type {"grid" | "free"} */ key, /** @type {string} */ text, /** @type {string} */ title) => {
    const input = make("input", { type: "checkbox", checked: editor.snap[key] });
    input.addEventListener("change", () => {
      editor.snap[key] = input.checked;
      editor.show();
    });
    return make("label", { className: "inline", title }, input, ` ${text}`);
  };
  const step = choice(["0.05", "0.1", "0.25", "0.5", "1"], String(editor.snap.step), (value) => {
    editor.snap.step = Number(value);
    editor.show();
  });
  step.setAttribute("aria-label", "step of the grid, m");
  return [
    box("grid", "grid", "places lie on a grid (Alt: not this one)"),
    step,
    box("free", "free ground", "what is placed in a wall goes to the nearest free place (Alt: not this one)"),
  ];
}

/** Save, and go to where experiments are composed. @param {Editor} editor */
async function driven(editor) {
  const { content, path, map, context } = editor;
  if (!content) return;
  await editor.autosave?.flush();
  context.navigate("run", { scenario: path, map, scenes: String(content.scenarios.length) });
}

/** @param {Editor} editor */
async function exported(editor) {
  const { content } = editor;
  if (!content) return;
  const format = await editor.context.ask(
    `Write the scene “${editor.scene.name}” for another program, beside this file:`,
    [...FORMATS, "Cancel"],
  );
  if (!format || !FORMATS.includes(format)) return;
  const target = newName(editor.path.replace(/\.json$/, `.${format}`), await editor.names());
  const made = await editor.context.api.post("/api/scenarios/export", {
    path: editor.path,
    content,
    map: editor.map,
    scene: editor.at,
    format,
    target,
  });
  const left = made.left_out.length
    ? `. Left out, for the format has no place for it: ${made.left_out.join(", ")}`
    : "";
  editor.context.say(`written: ${made.written.join(", ")}${left}`);
}

/** @param {Editor} editor */
export function sceneTabs(editor) {
  const tabs = make("div", { className: "tabs", role: "tablist", "aria-label": "scenes" });
  tabs.addEventListener("keydown", (event) => along(event));
  /** @param {KeyboardEvent} event */
  const along = (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const count = editor.content?.scenarios.length ?? 0;
    if (!step || !count) return;
    event.preventDefault();
    editor.turnTo((editor.at + step + count) % count);
    /** @type {HTMLElement | null} */ (tabs.querySelector("[aria-selected=true]"))?.focus();
  };
  const [add, copy] = [
    button("+", () => editor.addScene(false), { "aria-label": "add a scene", title: "add an empty scene" }),
    button("copy", () => editor.addScene(true), { title: "add a copy of this scene" }),
  ];
  const away = button("remove", () => editor.removeScene(), { title: "remove this scene" });
  const element = make("div", { className: "scenes row" }, tabs, make("span", { className: "row" }, add, copy, away));
  return {
    element,
    show() {
      const scenes = editor.content?.scenarios ?? [];
      element.hidden = !scenes.length;
      away.disabled = scenes.length < 2;
      tabs.replaceChildren(...scenes.map(({ name }, at) => tab(editor, name, at)));
    },
  };
}

/** @param {Editor} editor @param {string} name @param {number} at */
function tab(editor, name, at) {
  const wrong = editor.findings.filter(({ scene }) => scene === at).length;
  const is = at === editor.at;
  const text = wrong ? `${name} (${wrong})` : name;
  return button(text, () => editor.turnTo(at), {
    role: "tab",
    "aria-selected": String(is),
    tabIndex: is ? 0 : -1,
    className: wrong ? "bad" : "",
  });
}
