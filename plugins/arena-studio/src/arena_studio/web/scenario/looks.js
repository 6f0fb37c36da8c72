// Colours of the scenario editor, from the page's style sheet; groups of people have their own.

// those of `arena scenario draw`
export const GROUPS = ["#CC79A7", "#8E44AD", "#B7950B", "#117A65", "#56B4E9", "#C0392B"];
export const ROBOT = "#0072B2";
export const DOOR = "#6D4C41";
export const TRIGGER = "#56B4E9";
const NAMES = /** @type {const} */ ([
  "free",
  "wall",
  "unknown",
  "ink",
  "paper",
  "soft",
  "line",
  "accent",
  "person",
  "goal",
  "bad",
  "path",
]);

/** @typedef {Record<typeof NAMES[number], string>} Colours */

/** @param {Element} element @returns {Colours} */
export function coloursOf(element) {
  const style = getComputedStyle(element);
  return /** @type {Colours} */ (
    Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]))
  );
}

/**
 * The colour of each group, in the order in which they come.
 * @param {import("./model.js").Person[]} people
 * @returns {Map<string, string>}
 */
export function groupColours(people) {
  const names = [
    ...new Set(people.map(({ behaviour }) => String(behaviour?.group ?? "")).filter((name) => name !== "")),
  ];
  return new Map(names.map((name, at) => [name, GROUPS[at % GROUPS.length]]));
}

/** @param {string} colour #rrggbb @param {number} alpha */
export function faded(colour, alpha) {
  const [r, g, b] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  return `rgba(${r}, ${g}, ${b}, ${alpha})`;
}
