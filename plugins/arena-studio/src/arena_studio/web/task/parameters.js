// The parameters of a task as fields, each with unit, bounds and source; what differs from the defaults are the rules.

import { choice, make } from "studio/shell/forms.js";

/**
 * @typedef {{key: string, value: string, unit: string, text: string, kind: string, allowed: string, choices: string[],
 * optional: boolean}} Field
 */
/** @typedef {Record<string, string | number | boolean>} Rules  by the key behind `task.` */

export class Parameters {
  /** @param {() => void} changed */
  constructor(changed) {
    this.changed = changed;
    /** @type {Rules} */ this.rules = {};
    this.element = make("div", { className: "rules" });
  }

  /** The rules as words of a command line. */
  get words() {
    return Object.entries(this.rules).map(([key, value]) => `task.${key}=${value}`);
  }

  /** @param {Field[]} fields @param {string} title of those that are in no group */
  show(fields, title) {
    this.element.replaceChildren(
      ...groups(fields).map(([name, some]) =>
        make("fieldset", {}, make("legend", {}, name || title), ...some.map((field) => this.#field(field))),
      ),
    );
  }

  /** @param {Field} field */
  #field(field) {
    const key = nameOf(field);
    const set = (/** @type {string | number | boolean | null} */ value) => {
      if (value === null || String(value) === field.value) delete this.rules[key];
      else this.rules[key] = value;
      row.classList.toggle("other", key in this.rules);
      this.changed();
    };
    const unit = field.unit && field.unit !== "-" ? ` (${field.unit})` : "";
    const row = make(
      "label",
      { className: "field rule", title: field.text },
      make("span", {}, `${key.split(".").at(-1)?.replaceAll("_", " ")}${unit}`),
      inputOf(field, set),
      make("small", {}, field.allowed ? `${field.allowed}. ${field.text}` : field.text),
    );
    return row;
  }
}

/** @param {Field} field */
const nameOf = (field) => field.key.replace(/^task\./, "");

/** The fields by group, in their order. @param {Field[]} fields @returns {[string, Field[]][]} */
export function groups(fields) {
  /** @type {Map<string, Field[]>} */ const found = new Map();
  for (const field of fields) {
    const name = nameOf(field).split(".").slice(0, -1).join(" ");
    found.set(name, [...(found.get(name) ?? []), field]);
  }
  return [...found];
}

/** @param {Field} field @param {(value: string | number | boolean | null) => void} set null: the default */
function inputOf(field, set) {
  if (field.kind === "truth") {
    const box = make("input", { type: "checkbox", checked: field.value === "true" });
    box.addEventListener("change", () => set(box.checked));
    return box;
  }
  if (field.kind === "choice") return choice(field.choices, field.value, set);
  const [low, high] = boundsOf(field.allowed);
  const input = make("input", {
    type: "number",
    step: field.kind === "whole" ? "1" : "any",
    value: field.value,
    min: low,
    max: high,
  });
  input.addEventListener("change", () => {
    if (!input.validity.valid) input.reportValidity();
    else set(input.value === "" ? null : Number(input.value));
  });
  return input;
}

/**
 * The bounds that words such as `0 .. 1` or `>= 0 and <= 1000` say.
 * @param {string} allowed
 * @returns {[string, string]}
 */
export function boundsOf(allowed) {
  const between = /^(-?[\d.]+) \.\. (-?[\d.]+)$/.exec(allowed);
  if (between) return [between[1], between[2]];
  return [/>=? (-?[\d.e+]+)/.exec(allowed)?.[1] ?? "", /<= (-?[\d.e+]+)/.exec(allowed)?.[1] ?? ""];
}
