// Maps on their way between page and server: four bytes with the length of a header, the header in JSON, one byte a
// cell.

/** @param {Uint8Array} content @returns {{header: any, cells: Uint8Array}} */
export function unpacked(content) {
  const length = new DataView(content.buffer, content.byteOffset).getUint32(0, true);
  return {
    header: JSON.parse(new TextDecoder().decode(content.subarray(4, 4 + length))),
    cells: content.slice(4 + length),
  };
}

/** @param {any} header @param {Uint8Array} cells @returns {Uint8Array} */
export function packed(header, cells) {
  const text = new TextEncoder().encode(JSON.stringify(header));
  const body = new Uint8Array(4 + text.length + cells.length);
  new DataView(body.buffer).setUint32(0, text.length, true);
  body.set(text, 4);
  body.set(cells, 4 + text.length);
  return body;
}

/** @param {Uint8Array} body @returns {Promise<Blob>} */
export function zipped(body) {
  const stream = new Blob([/** @type {BlobPart} */ (body)]).stream().pipeThrough(new CompressionStream("gzip"));
  return new Response(stream).blob();
}
