// What a page of curves is made of: sections and charts, from top to bottom; charts stand side by side where they fit.

import { make } from "studio/shell/forms.js";
import { figure } from "studio/curves/chart.js";

/**
 * @typedef {{element?: HTMLElement, chart?: import("studio/curves/chart.js").Chart, more?: boolean}} Piece
 * @typedef {object} Kind how a kind of study is shown
 * @property {(found: any) => string} title
 * @property {(found: any, path: string) => Piece[]} pieces
 */

const GAP = 16; // px between charts
const WIDE = 430; // px that a chart takes at least where two stand beside each other

/** @param {Piece[]} pieces @param {number} width px that there are @returns {HTMLElement[]} */
export function layOut(pieces, width) {
  const columns = Math.max(1, Math.min(3, Math.floor((width + GAP) / (WIDE + GAP))));
  const each = Math.floor((width - GAP * (columns - 1)) / columns);
  /** @type {HTMLElement[]} */ const found = [];
  /** @type {HTMLElement | null} */ let row = null;
  for (const { element, chart } of pieces.filter(({ more }) => !more)) {
    if (chart) {
      if (!row) found.push((row = make("div", { className: "charts" })));
      row.append(figure(chart, each));
    } else if (element) {
      row = null;
      found.push(element);
    }
  }
  const folded = pieces.filter(({ more, chart }) => more && chart);
  if (folded.length) found.push(foldedCharts(folded, each));
  return found;
}

/** @param {Piece[]} pieces @param {number} width */
function foldedCharts(pieces, width) {
  const row = make("div", { className: "charts" });
  const details = make("details", {}, make("summary", {}, `${pieces.length} more curves`), row);
  const fill = () => {
    if (details.open && !row.children.length)
      row.append(...pieces.flatMap(({ chart }) => (chart ? [figure(chart, width)] : [])));
  };
  details.addEventListener("toggle", fill);
  return details;
}
