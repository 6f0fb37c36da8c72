// Ladders: curves of all planners under the limit, breaking densities, and the sentences on pairs.

import { make } from "studio/shell/forms.js";

/**
 * @typedef {object} Breaking a density, people per 100 m², with its interval
 * @property {number} value
 * @property {number} low
 * @property {number} high
 * @property {string} text
 *
 * @typedef {object} Curve
 * @property {[number, number][]} curve
 * @property {[number, number, number][]} driven density, share of successes, episodes
 * @property {Breaking} rho90
 * @property {Breaking} rho50
 *
 * @typedef {object} Result a planner on a robot
 * @property {string} planner
 * @property {string} robot
 * @property {number} highest
 * @property {Record<string, {success: Curve, strict_success?: Curve, clairvoyant?: Curve}>} cells
 *
 * @typedef {{rung: number, no_room: number, episodes: number, successes: number, density: number}} Block
 *
 * @typedef {object} Ladder
 * @property {{ladders: Result[], pairs: string[]}} document
 * @property {string[]} words
 * @property {number} cap
 * @property {string[]} cells
 * @property {Record<string, Block[]>} blocks by cell
 *
 * @typedef {"success" | "strict_success"} Kind
 */

const KINDS = /** @type {Record<Kind, string>} */ ({ success: "Success", strict_success: "Strict success" });
const SHARES = /** @type {["rho90" | "rho50", number][]} */ ([
  ["rho90", 0.9],
  ["rho50", 0.5],
]);

const APART = 0.022; // success by which a planner's intervals lie below those of the one before, so that all are seen

/** @param {Result} one */
const nameOf = ({ planner, robot }) => `${planner} on ${robot}`;
/** @param {string} cell */
const titleOfCell = (cell) => cell.replace("_", ", ");

/** @param {Ladder} found */
export function titleOf({ document, words }) {
  if (document.ladders.length) return `Ladder of ${document.ladders.map(nameOf).join(", ")}`;
  const given = Object.fromEntries(words.map((word) => word.split("=", 2)));
  return `Ladder of ${given.planner ?? "a planner"} on ${given.robot ?? "a robot"}`;
}

/** @param {Ladder} found @param {string} path @returns {import("studio/curves/pieces.js").Piece[]} */
export function ladderPieces(found, path) {
  const { ladders, pairs } = found.document;
  const charts = found.cells.map((cell) => ({ chart: ladders.length ? fitted(found, cell) : driven(found, cell) }));
  const kinds = /** @type {Kind[]} */ (Object.keys(KINDS));
  const tables = ladders.length ? kinds.map((kind) => ({ element: table(found, kind) })) : [];
  return [
    { element: make("div", {}, ...pairs.map((text) => make("p", { className: "answer" }, text)), standing(found)) },
    ...charts,
    ...tables,
    ...(found.words.length ? [{ element: compare(path) }] : []),
  ];
}

/** @param {Ladder} found */
function standing({ document, blocks, cap }) {
  const all = Object.values(blocks).flat();
  const count = all.reduce((sum, block) => sum + block.episodes + block.no_room, 0);
  const cells = Object.keys(blocks).length;
  const far = cells
    ? `${count} episodes in ${all.length} blocks of ${cells} cells, at most ${cap} episodes a cell. `
    : "";
  const curves = document.ladders.length
    ? "Points are what was driven, curves what was fitted to it; bars are the 95 % intervals of the " +
      "densities at which success falls to .9 and .5."
    : "Points are what was driven; curves come when the ladder ends.";
  return make("p", {}, far + curves);
}

/** @param {Ladder} found @param {string} cell @returns {import("studio/curves/chart.js").Chart} */
function fitted({ document }, cell) {
  const there = document.ladders.map((one, place) => ({ one, place })).filter(({ one }) => one.cells[cell]);
  const limits = there.filter(({ one }) => one.cells[cell].clairvoyant);
  const ends = Math.max(...there.map(({ one }) => one.highest));
  const lines = there.flatMap(({ one, place }) => {
    const { curve, driven: points } = one.cells[cell].success;
    return [
      { name: nameOf(one), points: curve, colour: place },
      dots(
        points.map(([x, y, n]) => ({ x, y, n })),
        place,
      ),
    ];
  });
  const limit = limits.map(({ one }) => ({
    name: limits.length > 1 ? `clairvoyant, where ${one.planner} drove` : "clairvoyant",
    look: /** @type {const} */ ("dashed"),
    points: one.cells[cell].clairvoyant?.curve ?? [],
    colour: 6,
  }));
  const bars = there.flatMap(({ one, place }) =>
    SHARES.map(([name, y]) => ({ ...one.cells[cell].success[name], y, colour: place }))
      .filter(({ value, low }) => value < ends && low < ends)
      .map(({ value, low, high, y, colour }) => ({ x: value, low, high, y: y - APART * colour, colour })),
  );
  return { ...frame(cell), lines: [...limit, ...lines], bars };
}

/**
 * What blocks came to, where no curve was fitted yet.
 * @param {Ladder} found @param {string} cell @returns {import("studio/curves/chart.js").Chart}
 */
function driven({ blocks }, cell) {
  const points = (blocks[cell] ?? [])
    .filter(({ episodes }) => episodes)
    .map(({ density, successes, episodes }) => ({ x: density, y: successes / episodes, n: episodes }))
    .sort((a, b) => a.x - b.x);
  return { ...frame(cell), lines: [{ ...dots(points, 0), name: "a block", look: "points" }] };
}

/** @param {string} cell */
function frame(cell) {
  return {
    key: cell,
    title: titleOfCell(cell),
    along: "people per 100 m²",
    levels: [0.9],
    across: /** @type {[number, number]} */ ([0, 1]),
  };
}

/** @param {{x: number, y: number, n: number}[]} points @param {number} colour */
function dots(points, colour) {
  return {
    name: "",
    look: /** @type {const} */ ("faint"),
    points: points.map(({ x, y }) => /** @type {[number, number]} */ ([x, y])),
    sizes: points.map(({ n }) => Math.min(7, 1.2 * Math.sqrt(n))),
    colour,
  };
}

/** @param {Ladder} found @param {Kind} kind */
function table({ document, cells }, kind) {
  const { ladders } = document;
  const several = ladders.length > 1;
  const heads = ladders.flatMap((one) => ["ρ90", "ρ50"].map((rho) => (several ? `${nameOf(one)}, ${rho}` : rho)));
  const rows = cells.map((cell) => {
    const texts = ladders.flatMap((one) => SHARES.map(([name]) => one.cells[cell]?.[kind]?.[name].text ?? "–"));
    const first = cell.split("_", 2).map((text) => make("td", {}, text));
    return make("tr", {}, ...first, ...texts.map((text) => make("td", {}, text)));
  });
  const head = ["world", "crowd", ...heads].map((text) => make("th", { scope: "col" }, text));
  return make(
    "section",
    { "aria-label": `breaking densities, ${KINDS[kind]}` },
    make("h2", {}, `${KINDS[kind]}: falls to .9 (ρ90) and .5 (ρ50) among so many people per 100 m²`),
    make(
      "div",
      { className: "scroll", tabIndex: 0, role: "region", "aria-label": `table of breaking densities, ${KINDS[kind]}` },
      make("table", { className: "values" }, make("thead", {}, make("tr", {}, ...head)), make("tbody", {}, ...rows)),
    ),
  );
}

/** @param {string} path */
function compare(path) {
  const command = `arena ladder report ${path} OTHER ... out=ladder_report`;
  return make(
    "section",
    { "aria-label": "compare" },
    make("h2", {}, "Beside each other"),
    make("p", {}, "Curves of several planners, and a sentence for each pair, from the maps that both drove:"),
    make("code", { className: "command" }, command),
  );
}
