// The tool and the panel that crop and enlarge a map.

import { button, choice, field, make } from "studio/shell/forms.js";
import { path, snap } from "studio/map/drawing.js";
import { toCells, toMetres } from "studio/map/frame.js";
import { NAMES } from "studio/map/kinds.js";
import { metres, number, section } from "studio/map/panels.js";
import { boxBetween, boxWithout } from "studio/map/resize.js";

/** @typedef {import("./grid.js").Box} Box */
/** @typedef {[number, number]} Point */

const SIDES = /** @type {const} */ (["left", "right", "top", "bottom"]);

/**
 * New edges, from corner to corner: what is outside goes, what lies beyond the old ones is new.
 * @param {import("./drawing.js").Desk} desk
 * @param {(box: Box) => void} resize
 * @returns {import("../edit/tools.js").Tool}
 */
export function extent(desk, resize) {
  /** @type {Point | null} */ let from = null;
  /** @type {Point | null} */ let to = null;
  const box = () => {
    const map = desk.map();
    return map && from && to ? boxBetween(toCells(map.frame, from), toCells(map.frame, to)) : null;
  };
  const moved = () => from !== null && to !== null && Math.hypot(to[0] - from[0], to[1] - from[1]) > 0;
  return {
    name: "crop",
    title: "Crop or enlarge: drag the map's new edges, which may lie outside it",
    key: "x",
    cursor: "crosshair",
    down: (hand) => void (from = to = snap(desk, hand)),
    move: (hand) => void (from && (to = snap(desk, hand))),
    up: () => {
      const chosen = moved() ? box() : null;
      [from, to] = [null, null];
      if (chosen) resize(chosen);
    },
    cancel: () => void (from = to = null),
    draw: (context, view) => {
      const [map, chosen] = [desk.map(), box()];
      if (!map || !chosen) return;
      const corners = /** @type {Point[]} */ ([
        [chosen.left, chosen.top],
        [chosen.right, chosen.top],
        [chosen.right, chosen.bottom],
        [chosen.left, chosen.bottom],
      ]);
      path(
        context,
        corners.map((cell) => toMetres(map.frame, cell)),
        true,
        2 * view.pixel,
        desk.colour(),
      );
    },
  };
}

/** @param {import("./editor.js").Editor} editor @returns {import("./panels.js").Panel} */
export function sizePanel(editor) {
  const { pencil } = editor;
  const inputs = SIDES.map(() => number(0, {}, () => show()));
  const beyond = choice([...NAMES], pencil.beyond, (kind) =>
    editor.setPencil({ beyond: /** @type {import("./kinds.js").Kind} */ (kind) }),
  );
  const facts = make("p", { className: "hint", role: "status" });
  const apply = button("Apply", () => {
    const box = asked();
    if (!box) return;
    editor.resize("crop or enlarge", box);
    for (const input of inputs) input.value = "0";
    show();
  });
  const trim = button("Cut off what is unknown", () => {
    const { map } = editor;
    const box = map && boxWithout(map.grid, map.kinds, NAMES.indexOf("unknown"));
    if (box) editor.resize("cut off what is unknown", box);
  });
  /** @returns {Box | null} */
  function asked() {
    const { map } = editor;
    if (!map) return null;
    const [left, right, top, bottom] = inputs.map((input) =>
      Math.round((input.valueAsNumber || 0) / map.frame.resolution),
    );
    const box = { left: -left, top: -top, right: map.grid.width + right, bottom: map.grid.height + bottom };
    return box.right > box.left && box.bottom > box.top ? box : null;
  }
  function show() {
    const { map } = editor;
    const box = asked();
    for (const element of [...inputs, apply, trim]) element.disabled = !map;
    apply.disabled ||= !box;
    facts.textContent = map ? (box ? sizeOf(box, map.frame.resolution) : "nothing would be left") : "No map is open.";
    beyond.value = pencil.beyond;
  }
  const fields = SIDES.map((side, at) => field(`${side}, m`, inputs[at]));
  const sides = make(
    "fieldset",
    {},
    make("legend", {}, "to add at each side; less than 0: to cut off"),
    make("div", { className: "pair" }, ...fields),
  );
  const element = section(
    "Size",
    false,
    sides,
    field("new cells are", beyond),
    make("div", { className: "row" }, apply, trim),
    facts,
    make(
      "p",
      { className: "hint" },
      "Or drag new edges with the tool crop (x). What stays is where it was: the origin moves with the corner.",
    ),
  );
  return { element, show };
}

/** @param {Box} box @param {number} resolution */
function sizeOf({ left, right, top, bottom }, resolution) {
  const [width, height] = [right - left, bottom - top];
  return `${width} × ${height} cells, ${metres(width * resolution)} × ${metres(height * resolution)} m`;
}
