// What the page asks for, without the DOM: filters, words, order, page; it stands in the address, so that a reload
// finds it again.

/**
 * @typedef {object} Asked
 * @property {Record<string, string[]>} allowed values by column
 * @property {string} text
 * @property {string} order
 * @property {boolean} falling
 * @property {number} page
 */

export const FILTERS = ["preset", "robot", "world", "outcome", "task", "run"];
export const SIZE = 50; // rows of a page

/** @param {URLSearchParams} query @returns {Asked} */
export function read(query) {
  const allowed = Object.fromEntries(
    FILTERS.map((name) => [name, query.getAll(name)]).filter(([, values]) => values.length),
  );
  const page = Math.floor(Number(query.get("page")));
  return {
    allowed,
    text: query.get("text") ?? "",
    order: query.get("order") ?? "",
    falling: query.get("falling") === "1",
    page: page > 0 ? page : 0,
  };
}

/** The words of the address. @param {Asked} asked */
export function written({ allowed, text, order, falling, page }) {
  const words = new URLSearchParams();
  for (const [name, values] of Object.entries(allowed)) for (const value of values) words.append(name, value);
  if (text) words.set("text", text);
  if (order) words.set("order", order);
  if (falling) words.set("falling", "1");
  if (page) words.set("page", String(page));
  return words.toString();
}

/**
 * Allow a value of a column, or no longer.
 * @param {Asked} asked
 * @param {string} column
 * @param {string} value
 * @param {boolean} on
 * @returns {Asked}
 */
export function allow(asked, column, value, on) {
  const before = asked.allowed[column] ?? [];
  const values = on ? [...before.filter((one) => one !== value), value] : before.filter((one) => one !== value);
  const allowed = { ...asked.allowed, [column]: values };
  if (!values.length) delete allowed[column];
  return { ...asked, allowed, page: 0 };
}

/**
 * Sort by a column: rising, then falling, then not at all.
 * @param {Asked} asked
 * @param {string} column
 * @returns {Asked}
 */
export function sort(asked, column) {
  if (asked.order !== column) return { ...asked, order: column, falling: false, page: 0 };
  return asked.falling ? { ...asked, order: "", falling: false, page: 0 } : { ...asked, falling: true, page: 0 };
}
