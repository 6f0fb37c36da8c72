// The panels beside the map: what is drawn with, scale and origin, another name, the measures.

import { button, field, make } from "studio/shell/forms.js";
import { NAMES } from "studio/map/kinds.js";

/**
 * @typedef {import("./editor.js").Editor} Editor
 * @typedef {{element: HTMLElement, show: () => void}} Panel `show` brings what it says up to date
 */

/**
 * A part of the side that can be closed.
 * @param {string} title
 * @param {boolean} open
 * @param {...(Node | string)} children
 */
export function section(title, open, ...children) {
  return make(
    "details",
    { open, className: "part" },
    make("summary", {}, title),
    make("div", { className: "inside" }, ...children),
  );
}

/**
 * A field for a number.
 * @param {number | string} value
 * @param {Record<string, any>} facts
 * @param {(value: number) => void} changed
 */
export function number(value, facts, changed) {
  const input = make("input", { type: "number", value: String(value), step: "any", ...facts });
  input.addEventListener("change", () => {
    const given = input.valueAsNumber;
    if (Number.isFinite(given) && input.checkValidity()) changed(given);
    else input.reportValidity();
  });
  return input;
}

/** @param {Editor} editor @returns {Panel} */
export function drawingPanel(editor) {
  const { pencil } = editor;
  const kinds = NAMES.map((kind, i) => {
    const swatch = make("span", { className: `swatch ${kind}` });
    const one = button("", () => editor.setPencil({ kind }), { title: `draw ${kind} (${i + 1})`, className: "kind" });
    one.append(swatch, kind);
    return one;
  });
  const width = number(pencil.width, { min: 0.01, max: 100 }, (value) => editor.setPencil({ width: value }));
  const step = number(pencil.step, { min: 0, max: 100 }, (value) => editor.setPencil({ step: value }));
  const filled = make("input", { type: "checkbox", checked: pencil.filled });
  filled.addEventListener("change", () => editor.setPencil({ filled: filled.checked }));
  const show = () => {
    kinds.forEach((one, i) => {
      one.setAttribute("aria-pressed", String(pencil.kind === NAMES[i]));
      one.disabled = editor.map !== null && editor.map.code(NAMES[i]) === null;
    });
    put(width, pencil.width);
    put(step, pencil.step);
    filled.checked = pencil.filled;
  };
  const element = section(
    "Draw",
    true,
    make("div", { className: "row kinds", role: "group", "aria-label": "what is drawn" }, ...kinds),
    make("div", { className: "pair" }, field("thickness, m", width), field("snap to, m", step)),
    make("label", {}, filled, " fill rectangles and polygons"),
    make("p", { className: "hint" }, "0 m: no snapping; Alt draws without it. Shift keeps lines to eighths of a turn."),
  );
  return { element, show };
}

/** @param {Editor} editor @returns {Panel} */
export function keysPanel(editor) {
  const resolution = number("", { min: 1e-6, max: 1000 }, (value) =>
    editor.map?.setKeys("set the scale", { resolution: value }),
  );
  const corner = [0, 1, 2].map((axis) =>
    number("", {}, (value) =>
      editor.map?.setKeys("set the origin", { origin: replaced(editor.map.header.origin, axis, value) }),
    ),
  );
  const real = number("", { min: 0.001 }, (value) => {
    const { map, measured } = editor;
    if (map && measured) map.setKeys("set the scale", { resolution: Number((value / measured.cells).toPrecision(9)) });
    editor.measured = null;
    editor.show();
  });
  const length = field("real length, m", real);
  const told = make("p", { className: "hint" });
  const facts = make("p", { className: "hint" });
  const origin = ["x, m", "y, m", "yaw, rad"].map((text, axis) => field(text, corner[axis]));
  const show = () => {
    const { map, measured } = editor;
    put(resolution, map?.header.resolution);
    corner.forEach((input, axis) => put(input, map?.header.origin[axis]));
    put(real, measured ? Number(measured.metres.toFixed(3)) : undefined);
    length.hidden = !measured;
    told.textContent = measured
      ? `Measured ${metres(measured.metres)} m. What it really is gives the scale.`
      : "The ruler (m) measures a length; what it really is gives the scale.";
    facts.textContent = map ? factsOf(map.header) : "No map is open.";
  };
  const place = make(
    "fieldset",
    {},
    make("legend", {}, "origin: the lower left corner"),
    make("div", { className: "triple" }, ...origin),
  );
  return {
    element: section("Scale and origin", false, field("scale, m a cell", resolution), place, told, length, facts),
    show,
  };
}

/**
 * Show a value in a field, not in one that is being written in.
 * @param {HTMLInputElement} input
 * @param {number | undefined} value
 */
function put(input, value) {
  input.disabled = value === undefined;
  if (document.activeElement !== input) input.value = value === undefined ? "" : String(value);
}

/**
 * @param {[number, number, number]} origin
 * @param {number} axis
 * @param {number} value
 * @returns {[number, number, number]}
 */
function replaced(origin, axis, value) {
  const [x, y, yaw] = origin.map((old, i) => (i === axis ? value : old));
  return [x, y, yaw];
}

/** @param {import("./model.js").Header} header */
function factsOf({ width, height, resolution, mode, image, negate }) {
  const size = `${width} × ${height} cells, ${metres(width * resolution)} × ${metres(height * resolution)} m`;
  return [size, `mode ${mode}`, image ?? "", negate ? "negate 1" : ""].filter(Boolean).join(" · ");
}

/** @param {number} value */
export function metres(value) {
  return value.toFixed(value < 10 ? 2 : 1);
}

/** @param {Editor} editor @returns {Panel} */
export function namePanel(editor) {
  const name = make("input", { placeholder: "maps/hall.yaml", spellcheck: false });
  const keep = async () => {
    if (!editor.map || !name.value) return;
    await editor.trying(async () => {
      await editor.map?.keepAs(name.value);
      editor.context.say(`kept as ${editor.map?.header.path}`);
      name.value = "";
    });
  };
  const element = section(
    "Keep as another map",
    false,
    field("file, in the project", name),
    button("Keep a copy and go on with it", keep),
  );
  return { element, show: () => {} };
}

/** @param {Editor} editor @returns {Panel} */
export function measuresPanel(editor) {
  const radius = number(0.35, { min: 0, max: 10 }, () => {});
  const rows = make("tbody");
  const told = make("p", { className: "hint" }, "Of the map as it is saved, as `arena world measure` says them.");
  /** @type {{map: Editor["map"], edits: number | undefined}} */ let of = { map: null, edits: 0 };
  const measure = button("Measure", () => editor.trying(measured));
  async function measured() {
    const path = editor.map?.header.path;
    if (!path) throw new Error("The map is no file yet; draw on it, or keep it under a name.");
    await editor.map?.autosave.flush();
    measure.disabled = true;
    try {
      const { measures } = await editor.context.api.get(
        `/api/maps/measures?path=${encodeURIComponent(path)}&robot_radius=${radius.valueAsNumber}`,
      );
      rows.replaceChildren(...measures.map(row));
      of = { map: editor.map, edits: editor.map?.edits };
      show();
    } finally {
      measure.disabled = false;
    }
  }
  const show = () => element.classList.toggle("old", of.map !== editor.map || of.edits !== editor.map?.edits);
  const table = make("table", { className: "measures" }, rows);
  const element = section(
    "Measures",
    false,
    make("div", { className: "pair end" }, field("robot radius, m", radius), measure),
    table,
    told,
  );
  return { element, show };
}

/** @param {{name: string, value: number, unit: string, text: string}} measure */
function row({ name, value, unit, text }) {
  const shown = value < 100 ? Number(value.toPrecision(3)).toString() : value.toFixed(0);
  const [cell, said] = [
    make("td", { className: "number" }, shown),
    make("td", { className: "soft" }, unit.replace("m2", "m²").replace("-", "")),
  ];
  return make("tr", { title: text }, make("th", { scope: "row" }, name.replaceAll("_", " ")), cell, said);
}
