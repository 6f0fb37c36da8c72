// The values of each column with how many episodes they would leave; ticked ones are allowed.

import { make } from "studio/shell/forms.js";

const TITLES = /** @type {Record<string, string>} */ ({ preset: "planner" });
const MOST = 40; // values of a column that are listed

/** @param {string} column */
export const titleOf = (column) => TITLES[column] ?? column.replaceAll("_", " ");

/**
 * @param {Record<string, Record<string, number>>} counts @param {Record<string, string[]>} allowed
 * @param {(column: string, value: string, on: boolean) => void} changed
 */
export function filters(counts, allowed, changed) {
  return Object.entries(counts).map(([column, values]) => {
    const ticked = new Set(allowed[column] ?? []);
    const listed = Object.entries(values).sort(
      ([a], [b]) => Number(ticked.has(b)) - Number(ticked.has(a)) || a.localeCompare(b, undefined, { numeric: true }),
    );
    const lines = listed.slice(0, MOST).map(([value, count]) => line(column, value, count, ticked.has(value), changed));
    const rest =
      listed.length > MOST
        ? [make("p", { className: "hint" }, `and ${listed.length - MOST} more: look for their names above`)]
        : [];
    const legend = make("summary", {}, titleOf(column), ticked.size ? ` (${ticked.size})` : "");
    return make(
      "details",
      { open: column !== "run" || ticked.size > 0, className: "filter", "data-column": column },
      legend,
      ...lines,
      ...rest,
    );
  });
}

/**
 * @param {string} column
 * @param {string} value
 * @param {number} count
 * @param {boolean} on
 * @param {(column: string, value: string, on: boolean) => void} changed
 */
function line(column, value, count, on, changed) {
  const box = make("input", { type: "checkbox", checked: on });
  box.dataset.value = value;
  box.addEventListener("change", () => changed(column, value, box.checked));
  const name = make("span", { className: "name", title: value }, value.replaceAll("_", " ") || "(none)");
  return make("label", {}, box, name, make("span", { className: "soft number" }, count.toLocaleString("en")));
}
