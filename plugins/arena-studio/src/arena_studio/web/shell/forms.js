// Elements in one call, and fields with their labels.

/**
 * Make an element: `make("p", { className: "soft" }, "text", child)`.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, any>} [facts] properties; names with a dash are attributes
 * @param {...(Node | string)} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function make(tag, facts = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(facts)) {
    if (name.includes("-") || name === "role") element.setAttribute(name, value);
    else /** @type {any} */ (element)[name] = value;
  }
  element.append(...children);
  return element;
}

let count = 0;

/**
 * A label above its field; `hint` stands below it, and is read with it.
 * @param {string} text @param {HTMLElement} input @param {string} [hint]
 */
export function field(text, input, hint = "") {
  input.id ||= `field-${++count}`;
  const label = make("label", { htmlFor: input.id }, text);
  if (!hint) return make("div", { className: "field" }, label, input);
  const words = make("p", { className: "hint", id: `${input.id}-hint` }, hint);
  input.setAttribute("aria-describedby", words.id);
  return make("div", { className: "field" }, label, input, words);
}

/** @param {string[]} options @param {string} value @param {(value: string) => void} changed */
export function choice(options, value, changed) {
  const select = make("select", {}, ...options.map((option) => new Option(option, option)));
  select.value = value;
  select.addEventListener("change", () => changed(select.value));
  return select;
}

/** @param {string} text @param {() => void} act @param {Record<string, any>} [facts] */
export function button(text, act, facts = {}) {
  const element = make("button", { type: "button", ...facts }, text);
  element.addEventListener("click", act);
  return element;
}

/**
 * Run `act` once nothing has asked for it for `ms`.
 * @template {unknown[]} A
 * @param {(...given: A) => void} act
 * @param {number} ms
 */
export function settled(act, ms) {
  let timer = 0;
  return (/** @type {A} */ ...given) => {
    window.clearTimeout(timer);
    timer = window.setTimeout(() => act(...given), ms);
  };
}
