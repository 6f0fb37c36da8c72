import assert from "node:assert/strict";
import { test } from "node:test";
import { History } from "../../src/arena_studio/web/edit/undo.js";
import { snapped, toCells, toMetres, windowOf } from "../../src/arena_studio/web/map/frame.js";
import { Grid, TILE } from "../../src/arena_studio/web/map/grid.js";
import { copyName } from "../../src/arena_studio/web/map/names.js";

const [WIDTH, HEIGHT] = [2 * TILE + 10, TILE + 5];

/** @param {Grid} grid @param {number[][]} runs row, left, right, code */
function stroke(grid, ...runs) {
  grid.begin();
  for (const [row, left, right, code] of runs) grid.run(row, left, right, code);
  return grid.end("stroke");
}

test("a stroke is taken back and done again, byte for byte", () => {
  const start = Uint8Array.from({ length: WIDTH * HEIGHT }, (_, i) => (i * 7) % 251);
  const grid = new Grid(WIDTH, HEIGHT, start.slice());
  const history = new History();
  history.keep(/** @type {any} */ (stroke(grid, [3, -5, WIDTH + 9, 1], [TILE + 1, 100, 140, 2])));
  history.keep(/** @type {any} */ (stroke(grid, [3, 7, 9, 3])));
  const end = grid.cells.slice();
  history.undo();
  history.undo();
  assert.deepEqual(grid.cells, start);
  history.redo();
  history.redo();
  assert.deepEqual(grid.cells, end);
});

test("a stroke that changes nothing is no step, a cancelled one leaves nothing", () => {
  const grid = new Grid(4, 4, new Uint8Array(16));
  assert.equal(stroke(grid, [1, 0, 4, 0], [9, 0, 4, 1], [2, 3, 3, 1]), null);
  assert.equal(grid.unsaved.size, 0);
  grid.begin();
  grid.run(0, 0, 4, 5);
  grid.cancel();
  assert.deepEqual(grid.cells, new Uint8Array(16));
});

test("tiles of one code take no memory", () => {
  const grid = new Grid(WIDTH, HEIGHT, new Uint8Array(WIDTH * HEIGHT));
  grid.begin();
  for (let row = 0; row < HEIGHT; row++) grid.run(row, 0, WIDTH, 9);
  assert.ok((grid.end("fill")?.bytes ?? Infinity) < 100);
});

test("unsaved tiles are told once, as few rectangles, with their codes", () => {
  const grid = new Grid(WIDTH, HEIGHT, new Uint8Array(WIDTH * HEIGHT));
  stroke(grid, [0, 0, TILE + 1, 4]);
  stroke(grid, [TILE, WIDTH - 1, WIDTH, 5]);
  const { boxes } = grid.takeUnsaved();
  assert.deepEqual(boxes, [
    [0, 0, 2 * TILE, TILE],
    [2 * TILE, TILE, 10, 5],
  ]);
  const codes = grid.codesOf(boxes);
  assert.deepEqual(
    [codes.length, codes[TILE], codes[TILE + 1], codes[2 * TILE * TILE + 9]],
    [2 * TILE * TILE + 50, 4, 0, 5],
  );
  assert.deepEqual(grid.takeUnsaved().boxes, []);
});

test("undoing what is saved makes it unsaved again", () => {
  const grid = new Grid(4, 4, new Uint8Array(16));
  const command = stroke(grid, [0, 0, 4, 1]);
  grid.takeUnsaved();
  command?.undo();
  assert.deepEqual(grid.takeUnsaved().boxes, [[0, 0, 4, 4]]);
});

test("the view is told where something changed", () => {
  const boxes = [];
  const grid = new Grid(4, 4, new Uint8Array(16), (box) => boxes.push(box));
  stroke(grid, [1, 1, 2, 1], [2, 3, 4, 1]);
  assert.deepEqual(boxes, [{ left: 1, top: 1, right: 4, bottom: 3 }]);
});

test("cells and metres are the same places, also where a map is turned", () => {
  const frame = { width: 30, height: 20, resolution: 0.05, origin: [-3, 2, 0.7] };
  const [column, row] = toCells(frame, toMetres(frame, [12.25, 3.5]));
  assert.ok(Math.abs(column - 12.25) < 1e-9 && Math.abs(row - 3.5) < 1e-9);
  const corner = toMetres(frame, [0, 20]);
  assert.ok(Math.abs(corner[0] + 3) < 1e-12 && Math.abs(corner[1] - 2) < 1e-12);
  assert.deepEqual(
    windowOf({ ...frame, origin: [1, 2, 0] }).map((side) => Number(side.toFixed(9))),
    [1, 2.5, 2, 3],
  );
});

test("points snap to lines between cells", () => {
  const frame = { width: 30, height: 20, resolution: 0.05, origin: [0.02, 0, 0] };
  const [x, y] = snapped(frame, [0.31, 0.26], 0.1);
  assert.ok(Math.abs(x - 0.32) < 1e-9 && Math.abs(y - 0.3) < 1e-9);
  assert.deepEqual(snapped(frame, [0.31, 0.26], 0), [0.31, 0.26]);
});

test("copies count on", () => {
  assert.deepEqual(["hall.yaml", "a/hall_2.yml", "hall"].map(copyName), [
    "hall_2.yaml",
    "a/hall_3.yaml",
    "hall_2.yaml",
  ]);
});
