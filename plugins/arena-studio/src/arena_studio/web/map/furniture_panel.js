// The panel of the furniture: the scenario file and its problem, what is placed, what becomes of the piece that is
// chosen.

import { button, choice, field, make } from "studio/shell/forms.js";
import { section } from "studio/map/panels.js";

/** @param {import("./editor.js").Editor} editor @returns {import("./panels.js").Panel} */
export function furniturePanel(editor) {
  const { furniture } = editor;
  const place = make("div", { className: "stack" });
  const show = () => {
    const { files, file, problem, kinds, chosen } = furniture;
    if (!editor.map?.header.path)
      return refill(
        place,
        make("p", { className: "soft" }, "Furniture stands in scenario files of a map that is saved."),
      );
    const fresh = button("New scenario file", () => editor.trying(() => editor.newScenario()));
    if (!file)
      return refill(
        place,
        make("p", { className: "hint" }, "No map holds furniture: it stands in the problems of a scenario file."),
        fresh,
      );
    const open = (/** @type {string} */ path) => {
      const other = files.find((one) => one.path === path) ?? null;
      furniture.open(other, other?.problems[0]?.name ?? "");
    };
    const names = file.problems.map((one) => one.name);
    const select = choice(Object.keys(kinds), furniture.kind, (kind) => void (furniture.kind = kind));
    const acts = [
      button("⟲", () => furniture.turn(1), { title: "turn left ([)", "aria-label": "turn left" }),
      button("⟳", () => furniture.turn(-1), { title: "turn right (])", "aria-label": "turn right" }),
      button("Remove", () => furniture.remove()),
    ];
    for (const one of acts) one.disabled = chosen < 0;
    refill(
      place,
      field(
        "scenario file",
        choice(
          files.map((one) => one.path),
          file.path,
          open,
        ),
      ),
      field(
        "problem",
        choice(names, problem, (name) => furniture.open(file, name)),
      ),
      field("to place", select),
      make(
        "div",
        { className: "row" },
        button("Place (t)", () => editor.toolbox.choose("furniture")),
        ...acts,
      ),
      make(
        "p",
        { className: "hint" },
        `${furniture.pieces.length} pieces. No map holds furniture; the lidar sees its legs.`,
      ),
    );
  };
  return { element: section("Furniture", false, place), show };
}

/**
 * Put other children into an element; the one in the place of that which had the focus gets it.
 * @param {HTMLElement} place
 * @param {...Node} children
 */
function refill(place, ...children) {
  const fields = () => [...place.querySelectorAll("button, select")];
  const at = fields().indexOf(/** @type {Element} */ (document.activeElement));
  place.replaceChildren(...children);
  const next = at >= 0 ? fields()[at] : null;
  if (next instanceof HTMLElement) next.focus();
}
