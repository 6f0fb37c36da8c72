import assert from "node:assert/strict";
import test from "node:test";
import { cellAt, centreOf, groundOf, hasRoom, toFree, windowOf } from "studio/scenario/ground.js";

/** A room of 20 by 10 cells of 0.1 m with a wall around, an unknown column beyond it. */
function room() {
  const [width, height] = [20, 10];
  const cells = new Uint8Array(width * height);
  for (let row = 0; row < height; row++) {
    for (let column = 0; column < width; column++) {
      if (column === width - 1) cells[row * width + column] = 2;
      else if (row === 0 || row === height - 1 || column === 0 || column === width - 2) cells[row * width + column] = 1;
    }
  }
  return { resolution: 0.1, origin: [1, 2, 0], width, height, cells };
}

test("cells and points fit each other, also where the map is turned", () => {
  const turned = { ...room(), origin: [1, 2, 0.7] };
  for (const ground of [room(), turned]) assert.deepEqual(cellAt(ground, centreOf(ground, 7, 3)), [7, 3]);
});

test("a point in a wall goes to the nearest place with room, and one with room stays", () => {
  const ground = room();
  assert.deepEqual(toFree(ground, [2, 2.5], 0.15), [2, 2.5]);
  const [x, y] = toFree(ground, [1.05, 2.5], 0.15);
  assert.ok(Math.abs(x - 1.25) < 1e-9 && Math.abs(y - 2.5) < 0.11, `${x} ${y}`);
  assert.ok(hasRoom(ground, ...cellAt(ground, [x, y]), 0.15));
  assert.deepEqual(toFree(ground, [9, 9], 0.15), [9, 9]);
});

test("the window is what of the map is known", () => {
  const [left, right] = windowOf(room());
  assert.ok(Math.abs(left - 0.55) < 1e-9 && Math.abs(right - 3.35) < 1e-9, `${left} ${right}`);
});

test("cells come packed", async () => {
  const stream = new Blob([new Uint8Array([0, 1, 2, 0])]).stream().pipeThrough(new CompressionStream("gzip"));
  const packed = Buffer.from(await new Response(stream).arrayBuffer()).toString("base64");
  const ground = await groundOf({ resolution: 0.05, origin: [0, 0, 0], shape: [2, 2], cells: packed });
  assert.deepEqual([...ground.cells], [0, 1, 2, 0]);
});
