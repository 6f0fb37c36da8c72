// One select a group of the configuration; another one beside it makes a sweep.

import { button, field, make } from "studio/shell/forms.js";

/**
 * @typedef {{name: string, chosen: string, optional: boolean, first: boolean, options: {name: string, about:
 * string}[]}} Group
 */

const LISTED = ["metrics"]; // several options of it are one choice, not a sweep

/** @param {string} name */
export const titleOf = (name) => name.replaceAll("_", " ");

/**
 * The selects of a group.
 * @param {Group} group @param {string[]} chosen @param {(options: string[]) => void} changed
 */
export function chooser(group, chosen, changed) {
  const place = make("div", { className: "chooser" });
  const values = chosen.length ? [...chosen] : [""];

  function select(/** @type {number} */ index) {
    const none = group.chosen === "null" ? "none" : `as usual: ${group.chosen.replaceAll(",", ", ")}`;
    const options = [
      new Option(index ? "choose another" : none, ""),
      ...group.options.map(({ name }) => new Option(name, name)),
    ];
    const element = make(
      "select",
      { "aria-label": index ? `${titleOf(group.name)}, another` : titleOf(group.name) },
      ...options,
    );
    element.value = values[index];
    element.addEventListener("change", () => {
      values[index] = element.value;
      changed(values);
      show();
    });
    return element;
  }

  function show() {
    const about = values.filter(Boolean).map((value) => group.options.find(({ name }) => name === value)?.about ?? "");
    const first = field(titleOf(group.name), select(0), about[0] ?? "");
    const others = values.slice(1).map((_, index) => select(index + 1));
    place.replaceChildren(first, ...others, ...(values.every(Boolean) ? [more()] : []));
  }

  function more() {
    const text = LISTED.includes(group.name) ? "and another" : "compare with another";
    return button(
      `+ ${text}`,
      () => {
        values.push("");
        show();
        /** @type {HTMLElement} */ (place.querySelector("select:last-of-type")).focus();
      },
      { className: "quiet", "aria-label": `${titleOf(group.name)}: ${text}` },
    );
  }

  show();
  return place;
}
