// What the codes of a map stand for: free, occupied or unknown, and in which colours they are seen.

export const WALL = 65; // occupancy from which on a cell is a wall
export const NAMES = /** @type {const} */ (["free", "occupied", "unknown"]);

/** @typedef {typeof NAMES[number]} Kind */

/** @param {number} value occupancy, -1 .. 100 @returns {Kind} */
export function kindOf(value) {
  if (value < 0) return "unknown";
  return value >= WALL ? "occupied" : "free";
}

/** Which kind each code is of, as numbers. @param {number[]} values @returns {Uint8Array} */
export function kindsOf(values) {
  const kinds = new Uint8Array(256);
  values.forEach((value, code) => (kinds[code] = NAMES.indexOf(kindOf(value))));
  return kinds;
}

/**
 * Which code is seen where a pixel has several: walls before all, what is free before what is unknown.
 * @param {number[]} values
 * @returns {Uint8Array}
 */
export function ranksOf(values) {
  const ranks = new Uint8Array(256);
  values.forEach((value, code) => (ranks[code] = value + 1));
  return ranks;
}

/**
 * The codes' colours as pixels of an image; between free and wall they are mixed.
 * @param {number[]} values
 * @param {{free: string, wall: string, unknown: string}} page #rrggbb
 * @returns {Uint32Array}
 */
export function coloursOf(values, page) {
  const colours = new Uint32Array(256);
  const [free, wall, unknown] = [page.free, page.wall, page.unknown].map(channels);
  values.forEach((value, code) => {
    const share = Math.max(value, 0) / 100;
    const mixed = value < 0 ? unknown : free.map((channel, i) => Math.round(channel + share * (wall[i] - channel)));
    colours[code] = (255 << 24) | (mixed[2] << 16) | (mixed[1] << 8) | mixed[0];
  });
  return colours;
}

/** @param {string} colour #rrggbb */
function channels(colour) {
  return [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
}
