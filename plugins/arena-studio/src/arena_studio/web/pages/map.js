// The page of the map editor.

import { guardPage } from "studio/edit/autosave.js";
import { button, make } from "studio/shell/forms.js";
import { Editor } from "studio/map/editor.js";
import { generatePanel } from "studio/map/generate.js";
import { sizePanel } from "studio/map/extent.js";
import { furniturePanel } from "studio/map/furniture_panel.js";
import { drawingPanel, keysPanel, measuresPanel, namePanel } from "studio/map/panels.js";

const SAID = {
  saved: "saved",
  changed: "…",
  saving: "saving …",
  away: "not saved: the studio does not answer; trying again",
  refused: "not saved",
  conflict: "conflict: not saved",
};

const EMPTY = { kind: "empty", seed: 0, parameters: {} };

/** @type {import("../shell/pages.js").Page} */
export const page = { name: "map", title: "Maps", mount };

/** @param {HTMLElement} root @param {import("../shell/pages.js").Context} context */
async function mount(root, context) {
  const style = make("link", { rel: "stylesheet", href: "/web/map/map.css" });
  const styled = new Promise((done) => style.addEventListener("load", done, { once: true }));
  document.head.append(style);
  await styled;
  const parts = layOut(root);
  const editor = new Editor(
    context,
    parts.canvas,
    () => show(),
    (state, said) => tell(parts.state, state, said),
    (text) => void (parts.where.textContent = text),
  );
  /** @type {any} */ (root).editor = editor; // for whoever tests the page
  const panels = [
    drawingPanel(editor),
    keysPanel(editor),
    sizePanel(editor),
    generatePanel(editor),
    furniturePanel(editor),
    measuresPanel(editor),
    namePanel(editor),
  ];
  parts.side.append(...panels.map((panel) => panel.element));
  const { undo, redo, select } = topBar(parts.top, editor, parts.state);
  editor.toolbox.fill(parts.tools);

  function show() {
    for (const panel of panels ?? []) panel.show();
    undo.disabled = !editor.map?.history.canUndo;
    redo.disabled = !editor.map?.history.canRedo;
    parts.empty.hidden = editor.map !== null;
    mark(select, editor.map?.header.path ?? "");
  }
  const stop = listen(editor);
  await editor.trying(() => list(context, select));
  show();
  const path = context.query.get("path");
  if (path) await editor.trying(() => editor.open(path));
  return () => {
    stop();
    style.remove();
    void editor.close();
  };
}

/** @param {HTMLElement} root */
function layOut(root) {
  const canvas = make("canvas", {
    tabIndex: 0,
    role: "application",
    "aria-label":
      "the map: arrows move a crosshair, Enter presses and lets go of the tool, Escape drops what was begun",
  });
  const top = make("div", { className: "top row", role: "toolbar", "aria-label": "map" });
  const tools = make("div", { className: "tools", "aria-label": "tools" });
  const side = make("div", { className: "side" });
  const state = make("span", { className: "state soft", role: "status" });
  const where = make("p", { className: "where soft" });
  const empty = make(
    "p",
    { className: "empty soft" },
    "Choose a map above, begin one by “New”, or draw one under “Generate”.",
  );
  root.append(
    make("h1", { className: "hidden" }, page.title),
    top,
    tools,
    make("div", { className: "stage" }, canvas, empty, where),
    side,
  );
  return { canvas, top, tools, side, state, where, empty };
}

/** @param {HTMLElement} top @param {Editor} editor @param {HTMLElement} state */
function topBar(top, editor, state) {
  const select = make("select", { "aria-label": "map" });
  select.addEventListener("change", () => select.value && editor.trying(() => editor.open(select.value)));
  const fresh = button("New", () => void editor.trying(() => editor.drawWorld(EMPTY)), {
    title: "an empty room within walls; Size changes its extent",
  });
  const undo = button("Undo", () => editor.map?.history.undo(), { title: "undo (Ctrl Z)" });
  const redo = button("Redo", () => editor.map?.history.redo(), { title: "redo (Ctrl Shift Z)" });
  const whole = button("Whole map", () => editor.view.fit(), { title: "show the whole map (0)" });
  const zoom = [
    button("−", () => editor.view.zoom(0.8), { "aria-label": "zoom out" }),
    button("+", () => editor.view.zoom(1.25), { "aria-label": "zoom in" }),
  ];
  const settle = button("Settle", () => void editor.map?.autosave.settle(), { className: "settle", hidden: true });
  top.append(select, fresh, undo, redo, ...zoom, whole, make("span", { className: "standing" }, state), settle);
  return { undo, redo, select };
}

/** @param {import("../shell/pages.js").Context} context @param {HTMLSelectElement} select */
async function list(context, select) {
  const { maps } = await context.api.get("/api/maps");
  select.replaceChildren(
    new Option(maps.length ? "Choose a map …" : "No map in this project yet", ""),
    ...maps.map((/** @type {string} */ path) => new Option(path, path)),
  );
}

/** Have the list show the open map, which may be new in it. @param {HTMLSelectElement} select @param {string} path */
function mark(select, path) {
  if (path && ![...select.options].some((option) => option.value === path)) select.append(new Option(path, path));
  select.value = path;
}

/** @param {HTMLElement} element @param {import("../edit/autosave.js").State} state @param {string} said */
function tell(element, state, said) {
  element.textContent =
    state === "refused" ? `${SAID[state]}: ${said}` : state === "saved" ? said || SAID[state] : SAID[state];
  element.className = `state ${state === "saved" || state === "saving" || state === "changed" ? "soft" : "bad"}`;
  const settle = element.closest(".top")?.querySelector(".settle");
  if (settle instanceof HTMLElement) settle.hidden = state !== "conflict";
}

/** @param {Editor} editor @returns {() => void} */
function listen(editor) {
  const press = (/** @type {KeyboardEvent} */ event) => editor.press(event);
  const focused = () => void editor.trying(() => editor.refresh());
  addEventListener("keydown", press);
  addEventListener("focus", focused);
  const unguard = [guardPage(() => editor.map?.autosave ?? null), guardPage(() => editor.furniture.autosave)];
  return () => {
    removeEventListener("keydown", press);
    removeEventListener("focus", focused);
    for (const drop of unguard) drop();
  };
}
