// The panels beside the map: what is drawn with, scale and origin, another name, the measures.

import { button, choice, field, make } from "studio/shell/forms.js";
import { NAMES } from "studio/map/kinds.js";

/**
 * @typedef {import("./editor.js").Editor} Editor
 * @typedef {{element: HTMLElement, show: () => void}} Panel `show` brings what it says up to date
 */

/** A part of the side that can be closed. @param {string} title @param {boolean} open @param {...(Node | string)} children */
export function section(title, open, ...children) {
  return make("details", { open, className: "part" }, make("summary", {}, title), make("div", { className: "inside" }, ...children));
}

/** A field for a number. @param {number | string} value @param {Record<string, any>} facts @param {(value: number) => void} changed */
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
    width.value = String(pencil.width);
    step.value = String(pencil.step);
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
  const place = make("div", { className: "stack" });
  const show = () => {
    const { map } = editor;
    if (!map) return place.replaceChildren(make("p", { className: "soft" }, "No map is open."));
    const { header } = map;
    const resolution = number(header.resolution, { min: 1e-6, max: 1000 }, (value) => map.setKeys("set the scale", { resolution: value }));
    const parts = ["x, m", "y, m", "yaw, rad"].map((text, i) =>
      field(
        text,
        number(header.origin[i], {}, (value) => {
          const origin = /** @type {[number, number, number]} */ (header.origin.map((old, j) => (j === i ? value : old)));
          map.setKeys("set the origin", { origin });
        }),
      ),
    );
    const size = `${header.width} × ${header.height} cells, ${metres(header.width * header.resolution)} × ${metres(header.height * header.resolution)} m`;
    const facts = [size, `mode ${header.mode}`, header.image ?? "", header.negate ? "negate 1" : ""].filter(Boolean);
    place.replaceChildren(
      field("scale, m a cell", resolution),
      make("fieldset", {}, make("legend", {}, "origin: the lower left corner"), make("div", { className: "triple" }, ...parts)),
      rulerRow(editor),
      make("p", { className: "hint" }, facts.join(" · ")),
    );
  };
  return { element: section("Scale and origin", false, place), show };
}

/** The scale by a length that is known. @param {Editor} editor */
function rulerRow(editor) {
  const { measured, map } = editor;
  if (!measured || !map) return make("p", { className: "hint" }, "The ruler (m) measures a length; what it really is gives the scale.");
  const real = number(Number(measured.metres.toFixed(3)), { min: 0.001 }, (value) => {
    map.setKeys("set the scale", { resolution: Number((value / measured.cells).toPrecision(9)) });
    editor.measured = null;
    editor.show();
  });
  return field(`measured ${metres(measured.metres)} m; really, m`, real);
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
  const element = section("Keep as another map", false, field("file, in the project", name), button("Keep a copy and go on with it", keep));
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
      const { measures } = await editor.context.api.get(`/api/maps/measures?path=${encodeURIComponent(path)}&robot_radius=${radius.valueAsNumber}`);
      rows.replaceChildren(...measures.map(row));
      of = { map: editor.map, edits: editor.map?.edits };
      show();
    } finally {
      measure.disabled = false;
    }
  }
  const show = () => element.classList.toggle("old", of.map !== editor.map || of.edits !== editor.map?.edits);
  const table = make("table", { className: "measures" }, rows);
  const element = section("Measures", false, make("div", { className: "pair end" }, field("robot radius, m", radius), measure), table, told);
  return { element, show };
}

/** @param {{name: string, value: number, unit: string, text: string}} measure */
function row({ name, value, unit, text }) {
  const shown = value < 100 ? Number(value.toPrecision(3)).toString() : value.toFixed(0);
  const [cell, said] = [make("td", { className: "number" }, shown), make("td", { className: "soft" }, unit.replace("m2", "m²").replace("-", ""))];
  return make("tr", { title: text }, make("th", { scope: "row" }, name.replaceAll("_", " ")), cell, said);
}

/** @param {Editor} editor @returns {Panel} */
export function furniturePanel(editor) {
  const { furniture } = editor;
  const place = make("div", { className: "stack" });
  const show = () => {
    const { files, file, problem, kinds, chosen } = furniture;
    if (!editor.map?.header.path) return place.replaceChildren(make("p", { className: "soft" }, "Furniture stands in scenario files of a map that is saved."));
    const fresh = button("New scenario file", () => editor.trying(() => editor.newScenario()));
    if (!file) return place.replaceChildren(make("p", { className: "hint" }, "No map holds furniture: it stands in the problems of a scenario file."), fresh);
    const open = (/** @type {string} */ path) => furniture.open(files.find((one) => one.path === path) ?? null, files.find((one) => one.path === path)?.problems[0]?.name ?? "");
    const names = file.problems.map((one) => one.name);
    const select = choice(Object.keys(kinds), furniture.kind, (kind) => void (furniture.kind = kind));
    const acts = [button("⟲", () => furniture.turn(1), { title: "turn left ([)" }), button("⟳", () => furniture.turn(-1), { title: "turn right (])" }), button("Remove", () => furniture.remove())];
    for (const one of acts) one.disabled = chosen < 0;
    place.replaceChildren(
      field("scenario file", choice(files.map((one) => one.path), file.path, open)),
      field("problem", choice(names, problem, (name) => furniture.open(file, name))),
      field("to place", select),
      make("div", { className: "row" }, button("Place (t)", () => editor.toolbox.choose("furniture")), ...acts),
      make("p", { className: "hint" }, `${furniture.pieces.length} pieces. No map holds furniture; the lidar sees its legs.`),
    );
  };
  return { element: section("Furniture", false, place), show };
}
