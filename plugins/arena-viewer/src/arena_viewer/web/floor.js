// A map's cells as a picture, made once, and where it lies.

/** @typedef {{resolution: number, origin: number[]}} Place  m, and x, y, theta of the lower left corner */

/**
 * Return a picture of cells, 0 free, 1 occupied, 2 unknown, a pixel each; its first row is the lowest.
 * @param {Uint8Array} cells by rows from below
 * @param {number} width
 * @param {number} height
 * @param {string[]} colours #rrggbb of the three
 */
export function pictureOf(cells, width, height, colours) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const image = context.createImageData(width, height);
  const packed = colours.map(
    (colour) =>
      0xff000000 |
      (parseInt(colour.slice(5, 7), 16) << 16) |
      (parseInt(colour.slice(3, 5), 16) << 8) |
      parseInt(colour.slice(1, 3), 16),
  );
  const pixels = new Uint32Array(image.data.buffer); // bytes of a little-endian machine: red first
  for (let i = 0; i < pixels.length; i++) pixels[i] = packed[cells[i]];
  context.putImageData(image, 0, 0);
  return canvas;
}

/**
 * Draw a picture where its map lies, in a context of metres, y up.
 * @param {CanvasRenderingContext2D} context
 * @param {Place} place
 * @param {HTMLCanvasElement} picture
 */
export function drawFloor(context, { resolution, origin }, picture) {
  context.save();
  context.translate(origin[0], origin[1]);
  context.rotate(origin[2]);
  context.imageSmoothingEnabled = false;
  context.drawImage(picture, 0, 0, picture.width * resolution, picture.height * resolution);
  context.restore();
}
