// The page of the scenario editor: joins the store, the view, the tools and the panels.

import { drawFloor, pictureOf } from "arena/floor.js";
import { guardPage } from "studio/edit/autosave.js";
import { isWriting, Toolbox, undoKeys } from "studio/edit/tools.js";
import { View } from "studio/edit/view.js";
import { fileBar, sceneTabs } from "studio/scenario/bar.js";
import { drawScene } from "studio/scenario/drawing.js";
import { Editor } from "studio/scenario/editor.js";
import { windowOf } from "studio/scenario/ground.js";
import { coloursOf, faded } from "studio/scenario/looks.js";
import { panels } from "studio/scenario/panel.js";
import { Preview } from "studio/scenario/preview.js";
import { toolsOf } from "studio/scenario/tools.js";
import { choice, make } from "studio/shell/forms.js";

const SAID = /** @type {Record<string, string>} */ ({
  saved: "saved",
  changed: "…",
  saving: "saving …",
  away: "not saved: the studio does not answer; trying again",
  refused: "not saved",
  conflict: "conflict: not saved",
});

/** @type {import("../shell/pages.js").Page} */
export const page = { name: "scenario", title: "Scenarios", mount };

/** @param {HTMLElement} root @param {import("../shell/pages.js").Context} context */
async function mount(root, context) {
  const style = await styled("/web/scenario/scenario.css");
  const kinds = await context.api.get("/api/scenarios/kinds");
  const state = make("span", { className: "state soft", role: "status" });
  const tell = (/** @type {string} */ name, /** @type {string} */ said) => {
    state.textContent = `${SAID[name]}${said && name !== "away" ? `: ${said}` : ""}`;
    state.classList.toggle("bad", ["away", "refused", "conflict"].includes(name));
  };
  const editor = new Editor(context, kinds, tell);
  const canvas = make("canvas", {
    tabIndex: 0,
    role: "application",
    "aria-label":
      "the scene: arrows move a crosshair, Enter presses and lets go of the tool, Escape drops what was begun",
  });
  const preview = new Preview(editor, canvas, () => view.request());
  const view = new View(canvas, layers(editor, preview, canvas));
  const toolbox = new Toolbox(view, toolsOf(editor, view));
  const [bar, tabs] = [fileBar(editor, state), sceneTabs(editor)];
  const side = panels(editor, (place) => look(view, place));
  layOut(root, {
    bar: bar.element,
    tabs: tabs.element,
    canvas,
    side: side.elements,
    preview: preview.bar(),
    toolbox,
    editor,
  });

  /** @type {unknown} */ let fitted = null;
  editor.listen(() => {
    for (const part of [bar, tabs, side]) part.show();
    view.step = editor.snap.grid ? editor.snap.step : 0;
    if (editor.content && fitted !== (editor.ground ?? editor.path)) view.fit(wholeOf(editor));
    fitted = editor.ground ?? editor.path;
    if (preview.scene && !preview.isShown) preview.stop();
    root.classList.toggle("none", !editor.content);
    view.request();
  });
  const stop = listen(editor, toolbox, view);
  await editor.trying(() => bar.load());
  editor.show();
  const path = context.query.get("path");
  if (path) await editor.trying(() => editor.open(path));
  /** @type {any} */ (root).editor = editor; // for whoever tests the page
  Object.assign(root, { view, preview });
  return () => {
    stop();
    preview.close();
    view.close();
    style.remove();
    void editor.close();
  };
}

/** Add a style sheet and wait for it. @param {string} address */
async function styled(address) {
  const style = make("link", { rel: "stylesheet", href: address });
  const done = new Promise((ready) => style.addEventListener("load", ready, { once: true }));
  document.head.append(style);
  await done;
  return style;
}

/**
 * @param {HTMLElement} root
 * @param {{bar: HTMLElement, tabs: HTMLElement, canvas: HTMLElement, side: HTMLElement[], preview: HTMLElement,
 * toolbox: Toolbox, editor: Editor}} parts
 */
function layOut(root, { bar, tabs, canvas, side, preview, toolbox, editor }) {
  const tools = make("div", { className: "tools", "aria-label": "tools" });
  toolbox.fill(tools);
  const pieces = choice(Object.keys(editor.kinds.furniture), editor.piece ?? "", (value) => {
    editor.piece = value;
    toolbox.choose("furniture");
  });
  const left = make(
    "div",
    { className: "left" },
    tools,
    make("label", { className: "field" }, make("span", {}, "furniture"), pieces),
  );
  const empty = make("p", { className: "empty soft" }, "Choose a scenario file above, or a map and “New”.");
  root.append(
    make("h1", { className: "hidden" }, page.title),
    bar,
    left,
    make("div", { className: "stage" }, tabs, make("div", { className: "picture" }, canvas, empty), preview),
    make("div", { className: "side" }, ...side),
  );
}

/**
 * @param {Editor} editor
 * @param {Preview} preview
 * @param {HTMLElement} element
 * @returns {import("../edit/view.js").Layer[]}
 */
function layers(editor, preview, element) {
  let colours = coloursOf(element);
  /** @type {{ground: unknown, dark: boolean, canvas: HTMLCanvasElement} | null} */ let picture = null;
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const looks = (/** @type {number} */ pixel) => ({
    colours,
    pixel,
    furniture: editor.kinds.furniture,
    robot: editor.robot,
    goalRadius: 0.3,
  });
  return [
    {
      name: "ground",
      draw(context, view) {
        colours = coloursOf(element);
        view.background = editor.ground ? colours.unknown : colours.free;
        const { ground } = editor;
        if (!ground) return;
        if (picture?.ground !== ground || picture.dark !== dark.matches)
          picture = {
            ground,
            dark: dark.matches,
            canvas: pictureOf(ground.cells, ground.width, ground.height, [colours.free, colours.wall, colours.unknown]),
          };
        drawFloor(context, ground, picture.canvas);
      },
    },
    { name: "grid", draw: (context, view) => drawGrid(context, view, editor, colours.line) },
    {
      name: "scene",
      draw(context, view) {
        if (!editor.content) return;
        context.globalAlpha = preview.isShown ? 0.35 : 1;
        drawScene(context, editor, looks(view.pixel));
        context.globalAlpha = 1;
      },
    },
    { name: "preview", draw: (_, view) => preview.draw(view.camera.scale) },
  ];
}

/**
 * The grid on which things are placed, where its lines stand apart.
 * @param {CanvasRenderingContext2D} context
 * @param {View} view
 * @param {Editor} editor
 * @param {string} colour
 */
function drawGrid(context, view, { snap, content }, colour) {
  if (!content || !snap.grid || snap.step / view.pixel < 9) return;
  const [left, right, bottom, top] = view.seen;
  context.beginPath();
  for (let x = snap.step * Math.ceil(left / snap.step); x <= right; x += snap.step) {
    context.moveTo(x, bottom);
    context.lineTo(x, top);
  }
  for (let y = snap.step * Math.ceil(bottom / snap.step); y <= top; y += snap.step) {
    context.moveTo(left, y);
    context.lineTo(right, y);
  }
  context.strokeStyle = faded(colour, 0.22);
  context.lineWidth = view.pixel;
  context.stroke();
}

/** What of a scene is worth showing: its map, or all that stands in it. @param {Editor} editor */
function wholeOf(editor) {
  if (editor.ground) return windowOf(editor.ground);
  const { start, goal, pedestrians = [] } = editor.scene;
  const points = [start, goal, ...pedestrians.flatMap(({ position, waypoints = [] }) => [position, ...waypoints])];
  const [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
  return [Math.min(...xs) - 2, Math.max(...xs) + 2, Math.min(...ys) - 2, Math.max(...ys) + 2];
}

/** Bring a place into sight. @param {View} view @param {number[]} place */
function look(view, [x, y]) {
  const [left, right, bottom, top] = view.seen;
  const margin = 30 * view.pixel;
  if (x > left + margin && x < right - margin && y > bottom + margin && y < top - margin) return;
  [view.camera.x, view.camera.y] = [x, y];
  view.request();
}

/** @param {Editor} editor @param {Toolbox} toolbox @param {View} view @returns {() => void} */
function listen(editor, toolbox, view) {
  /** @param {KeyboardEvent} event */
  const pressed = (event) => {
    if (isWriting(event.target) || event.defaultPrevented || document.querySelector("dialog[open]")) return;
    if (event.target instanceof HTMLElement && event.target.getAttribute("role") === "tab") return;
    if (undoKeys(event, editor.history)) return view.request();
    if (!toolbox.press(event)) return;
    event.preventDefault();
    view.request();
  };
  addEventListener("keydown", pressed);
  const unguard = guardPage(() => editor.autosave);
  return () => {
    removeEventListener("keydown", pressed);
    unguard();
  };
}
