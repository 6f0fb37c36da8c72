// The panel that draws worlds by kind and difficulty, as `arena world generate` does.

import { button, choice, field, make } from "studio/shell/forms.js";
import { number, section } from "studio/map/panels.js";

/**
 * @typedef {{name: string, parameters: Record<string, number | boolean | null>}} WorldKind  null: the difficulty
 * decides
 */

const FIRST = ["difficulty", "width", "height", "resolution"]; // shown before the others
const PREFERRED = "indoor";

/** @param {import("./editor.js").Editor} editor @returns {import("./panels.js").Panel} */
export function generatePanel(editor) {
  /** @type {WorldKind[]} */ let kinds = [];
  /** @type {Record<string, number | boolean | null>} */ let given = {};
  let kind = "";
  let seed = 0;
  const place = make("div", { className: "stack" });
  const seedField = number(0, { min: 0, step: 1 }, (value) => void (seed = value));

  const draw = () => editor.trying(() => editor.drawWorld({ kind, seed, parameters: given }));
  const again = () => {
    seed += 1;
    seedField.value = String(seed);
    return draw();
  };
  const choose = (/** @type {string} */ name) => {
    kind = name;
    given = {};
    show();
  };
  const show = () => {
    const found = kinds.find((one) => one.name === kind);
    if (!found) return place.replaceChildren(make("p", { className: "soft" }, "Asking for the kinds of worlds …"));
    const all = Object.entries(found.parameters);
    const rows = (/** @type {typeof all} */ list) =>
      make("div", { className: "pair" }, ...list.map(([name, value]) => parameter(name, value, given)));
    const [first, others] = [
      all.filter(([name]) => FIRST.includes(name)),
      all.filter(([name]) => !FIRST.includes(name)),
    ];
    place.replaceChildren(
      make(
        "div",
        { className: "pair" },
        field(
          "kind",
          choice(
            kinds.map((one) => one.name),
            kind,
            choose,
          ),
        ),
        field("seed", seedField),
      ),
      rows(first),
      ...(others.length ? [make("details", {}, make("summary", {}, "all parameters"), rows(others))] : []),
      make("div", { className: "row" }, button("Draw", draw, { className: "main" }), button("Next seed", again)),
      make("p", { className: "hint" }, "It becomes a file of the project with the first change, or when you keep it."),
    );
  };
  const load = async () => {
    kinds = (await editor.context.api.get("/api/maps/kinds")).kinds;
    choose(kinds.some((one) => one.name === PREFERRED) ? PREFERRED : kinds[0].name);
  };
  const element = section("Generate", false, place);
  element.addEventListener("toggle", () => {
    if (element.open && !kinds.length) void editor.trying(load);
  });
  show();
  return { element, show: () => {} };
}

/**
 * @param {string} name
 * @param {number | boolean | null} value
 * @param {Record<string, number | boolean | null>} given
 */
function parameter(name, value, given) {
  const text = name.replaceAll("_", " ");
  if (typeof value === "boolean") {
    const box = make("input", { type: "checkbox", checked: value });
    box.addEventListener("change", () => void (given[name] = box.checked));
    return make("label", {}, box, ` ${text}`);
  }
  const input = number(
    value ?? "",
    { placeholder: value === null ? "by difficulty" : "" },
    (set) => void (given[name] = set),
  );
  input.addEventListener("input", () => {
    if (!input.value) given[name] = null;
  });
  return field(text, input);
}
