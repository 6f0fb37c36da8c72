// The table of episodes: sorted by a click on a column's head; each episode opens in the viewer.

import { button, make } from "studio/shell/forms.js";
import { titleOf } from "studio/results/filters.js";

export const USUAL = [
  "run",
  "preset",
  "robot",
  "world",
  "scenario",
  "episode",
  "outcome",
  "success",
  "time_to_goal",
  "path_length",
  "collisions",
  "clearance_min",
];

/** @typedef {Record<string, string | number | boolean | null>} Row */

/** @param {unknown} value */
export function written(value) {
  if (value === null || value === undefined) return "";
  if (typeof value === "number" && !Number.isInteger(value))
    return Math.abs(value) >= 1000 ? value.toFixed(0) : value.toPrecision(4);
  return String(value).replaceAll("_", " ");
}

const TRUTHS = /success$/; // metrics of an episode that are 1 or 0: it was one, or not
// folders that are called after when they were made
const MADE = /^(?:outputs|multirun)\/\d{4}-(\d\d-\d\d)\/(\d\d)-(\d\d)-(\d\d)(?:-\d+)?/;

/** A cell of a column, as one reads it. @param {string} column @param {unknown} value */
export function shown(column, value) {
  if (TRUTHS.test(column) && (value === 1 || value === 0)) return value ? "yes" : "no";
  return column === "run" ? String(value).replace(MADE, "$1 $2:$3:$4") : written(value);
}

/** Which episodes are ticked, to be opened beside each other. */
export class Picked {
  constructor() {
    /** @type {Map<string, {run: string, episode: string}>} */ this.rows = new Map();
  }

  /** @param {Row} row */
  static key = (row) => `${row.run} ${row.episode}`;

  /** @param {Row} row @param {boolean} on */
  set(row, on) {
    if (on) this.rows.set(Picked.key(row), { run: String(row.run), episode: String(row.episode) });
    else this.rows.delete(Picked.key(row));
  }

  /** The viewer's address; nothing where the episodes have different numbers, and so different scenarios. */
  address() {
    const rows = [...this.rows.values()];
    if (!rows.length || rows.some(({ episode }) => episode !== rows[0].episode)) return "";
    return address(
      rows.map(({ run }) => run),
      rows[0].episode,
    );
  }
}

/** @param {string[]} runs @param {string | number} episode */
export function address(runs, episode) {
  return `/replay/?${new URLSearchParams([...runs.map((run) => ["run", run]), ["episode", String(episode)]])}`;
}

/**
 * @param {string[]} columns @param {Row[]} rows @param {{order: string, falling: boolean}} asked
 * @param {(column: string) => void} sorted @param {Picked} picked @param {() => void} ticked
 */
export function episodeTable(columns, rows, asked, sorted, picked, ticked) {
  const heads = columns.map((column) => head(column, asked, sorted));
  const first = [
    make("th", { scope: "col" }, make("span", { className: "hidden" }, "chosen")),
    make("th", { scope: "col" }, make("span", { className: "hidden" }, "replay")),
  ];
  const body = rows.map((row) => line(row, columns, picked, ticked));
  return make(
    "table",
    {},
    make("caption", { className: "hidden" }, "episodes"),
    make("thead", {}, make("tr", {}, ...first, ...heads)),
    make("tbody", {}, ...body),
  );
}

/** @param {string} column @param {{order: string, falling: boolean}} asked @param {(column: string) => void} sorted */
function head(column, { order, falling }, sorted) {
  const arrow = order === column ? (falling ? " ▼" : " ▲") : "";
  const cell = make(
    "th",
    { scope: "col" },
    button(titleOf(column) + arrow, () => sorted(column), { "data-column": column }),
  );
  if (arrow) cell.setAttribute("aria-sort", falling ? "descending" : "ascending");
  return cell;
}

/** @param {Row} row @param {string[]} columns @param {Picked} picked @param {() => void} ticked */
function line(row, columns, picked, ticked) {
  const named = `episode ${row.episode} of ${row.run}`;
  const box = make("input", {
    type: "checkbox",
    checked: picked.rows.has(Picked.key(row)),
    "aria-label": `choose ${named}`,
  });
  box.addEventListener("change", () => {
    picked.set(row, box.checked);
    ticked();
  });
  const replay = make(
    "a",
    {
      href: address([String(row.run)], String(row.episode)),
      target: "_blank",
      rel: "noopener",
      "aria-label": `replay ${named}`,
    },
    "replay",
  );
  const cells = columns.map((column) => {
    const value = row[column];
    const text = shown(column, value);
    const cell = make(
      "td",
      {
        className:
          column === "run" ? "run" : typeof value === "number" && text !== "yes" && text !== "no" ? "number" : "",
      },
      text,
    );
    if (column === "run") cell.title = String(value);
    if (column === "outcome" && row.error) cell.title = String(row.error);
    return cell;
  });
  return make("tr", {}, make("td", {}, box), make("td", {}, replay), ...cells);
}
