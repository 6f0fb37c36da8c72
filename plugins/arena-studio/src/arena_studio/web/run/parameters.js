// The parameters of an option as fields: unit, meaning and what is allowed stand beside each.

import { field, make } from "studio/shell/forms.js";

/**
 * @typedef {object} Parameter
 * @property {string} key
 * @property {string} value
 * @property {string} unit
 * @property {string} text
 * @property {"number" | "whole" | "truth" | "choice" | "text" | "other"} kind
 * @property {string} allowed
 * @property {string[]} choices
 * @property {boolean} optional
 */

/**
 * Why a text cannot be the value of a number, or nothing; the server has the last word.
 * @param {Parameter} parameter @param {string} text
 */
export function complaint({ kind, allowed, optional }, text) {
  if (kind !== "number" && kind !== "whole") return "";
  const parts = text
    .split(",")
    .map((part) => part.trim())
    .filter((part) => part && !(optional && part === "null"));
  const wrong = parts.find(
    (part) => !/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(part) || (kind === "whole" && !/^[+-]?\d+$/.test(part)),
  );
  return wrong === undefined
    ? ""
    : `${wrong} is no ${kind === "whole" ? "whole " : ""}number${allowed ? `; allowed: ${allowed}` : ""}`;
}

/**
 * A field for each parameter; an empty one leaves the value as it is.
 * @param {string} inside the group whose parameters they are
 * @param {Parameter[]} parameters
 * @param {(key: string) => string} given
 * @param {(key: string, text: string) => void} changed
 */
export function parameterFields(inside, parameters, given, changed) {
  return parameters.map((parameter) => {
    const input = parameter.kind === "truth" || parameter.kind === "choice" ? selected(parameter) : typed(parameter);
    input.value = given(parameter.key);
    input.dataset.key = parameter.key;
    input.addEventListener(input instanceof HTMLSelectElement ? "change" : "input", () =>
      changed(parameter.key, input.value),
    );
    const unit = parameter.unit && parameter.unit !== "-" ? ` [${parameter.unit}]` : "";
    const hint = [parameter.text, parameter.kind !== "choice" && parameter.allowed && `allowed: ${parameter.allowed}`]
      .filter(Boolean)
      .join("; ");
    const name = parameter.key.startsWith(`${inside}.`) ? parameter.key.slice(inside.length + 1) : parameter.key;
    return field(name + unit, input, hint);
  });
}

/** @param {Parameter} parameter */
function selected({ kind, choices, value, optional }) {
  const options = kind === "truth" ? ["true", "false"] : choices;
  return make(
    "select",
    {},
    new Option(`as it is: ${value}`, ""),
    ...[...options, ...(optional ? ["null"] : [])].map((one) => new Option(one, one)),
  );
}

/** @param {Parameter} parameter */
function typed(parameter) {
  const numeric = parameter.kind === "number" || parameter.kind === "whole";
  const input = make("input", {
    type: "text",
    placeholder: parameter.value,
    autocomplete: "off",
    spellcheck: false,
    inputMode: numeric ? "decimal" : "text",
  });
  input.addEventListener("input", () => {
    const said = complaint(parameter, input.value);
    input.setAttribute("aria-invalid", String(said !== ""));
    input.title = said;
  });
  return input;
}

/**
 * Show the values that hold now where nothing was changed.
 * @param {HTMLElement} root
 * @param {Record<string, string>} values
 */
export function showHeld(root, values) {
  for (const input of root.querySelectorAll("[data-key]")) {
    const held = values[/** @type {HTMLElement} */ (input).dataset.key ?? ""];
    if (held === undefined) continue;
    if (input instanceof HTMLInputElement) input.placeholder = held;
    else if (input instanceof HTMLSelectElement && !input.value) input.options[0].text = `as it is: ${held}`;
  }
}
