// Reads a replay document (docs/replay.md): header and arrays.

/** @typedef {{type: string, shape: number[], offset: number}} Said */
/** @typedef {Float32Array | Int32Array | Int8Array | Uint8Array} Values */
/**
 * @typedef {{values: Values, shape: number[], rows: number}} Table  values of row t and component c: values[c * rows +
 * t]
 */

const TYPES = /** @type {Record<string, any>} */ ({
  float32: Float32Array,
  int32: Int32Array,
  int8: Int8Array,
  uint8: Uint8Array,
});

/**
 * Return the bytes that a base64 text stands for.
 * @param {string} text
 * @returns {Uint8Array}
 */
export function bytesOf(text) {
  return Uint8Array.from(atob(text.trim()), (letter) => letter.charCodeAt(0));
}

/**
 * Unpack gzip.
 * @param {Uint8Array} packed
 * @returns {Promise<ArrayBuffer>}
 */
export async function unpack(packed) {
  const stream = new Blob([/** @type {BlobPart} */ (packed)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/**
 * Return a document's header with its arrays in place; throw an Error with one line where it is none.
 * @param {ArrayBuffer} raw
 * @returns {{maps: any[], episodes: any[]}}
 */
export function decode(raw) {
  const view = new DataView(raw);
  const magic = raw.byteLength < 8 ? "" : String.fromCharCode(...new Uint8Array(raw, 0, 4));
  if (magic !== "ARPL") throw new Error("this is no replay document");
  const size = view.getUint32(4, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(raw, 8, size)));
  if (header.version !== 1) throw new Error(`a replay document of version ${header.version}; this viewer knows 1`);
  const begin = Math.ceil((8 + size) / 8) * 8;
  /** @param {Said} said @returns {Table} */
  const table = (said) => {
    const count = said.shape.reduce((product, length) => product * length, 1);
    const values = new TYPES[said.type](raw, begin + said.offset, count);
    return { values, shape: said.shape, rows: said.shape[said.shape.length - 1] };
  };
  for (const map of header.maps) map.cells = table(map.cells);
  for (const episode of header.episodes) {
    for (const name of Object.keys(episode.arrays)) episode.arrays[name] = table(episode.arrays[name]);
  }
  return header;
}
