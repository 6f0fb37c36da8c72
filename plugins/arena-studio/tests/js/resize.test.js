import assert from "node:assert/strict";
import { test } from "node:test";
import { toMetres } from "../../src/arena_studio/web/map/frame.js";
import { kindsOf } from "../../src/arena_studio/web/map/kinds.js";
import { OpenMap } from "../../src/arena_studio/web/map/model.js";
import { boxBetween, boxWithout, originOf, resized } from "../../src/arena_studio/web/map/resize.js";

const OLD = { width: 3, height: 2, cells: Uint8Array.from([1, 2, 3, 4, 5, 6]) };
const HEADER = {
  path: "a.yaml",
  version: "1.2",
  resolution: 0.5,
  mode: "trinary",
  most_cells: 100,
  samples: [[254], [0], [205]],
  values: [0, 100, -1],
  drawn: { free: 0, occupied: 1, unknown: 2 },
};

/** @param {[number, number, number]} origin */
function opened(origin) {
  const told = { sizes: 0 };
  const hooks = { cells() {}, size: () => told.sizes++, steps() {}, state() {}, kept() {}, async reload() {} };
  const map = new OpenMap(
    /** @type {any} */ ({ ask: async () => null }),
    /** @type {any} */ ({ ...HEADER, width: 3, height: 2, origin }),
    Uint8Array.from([0, 1, 0, 0, 0, 1]),
    "a",
    hooks,
  );
  map.autosave.closed = true;
  return { map, told };
}

test("a map is cut off and enlarged on every side", () => {
  assert.deepEqual(resized(OLD, { left: 1, top: 0, right: 3, bottom: 1 }, 9), {
    width: 2,
    height: 1,
    cells: Uint8Array.from([2, 3]),
  });
  assert.deepEqual(
    [...resized(OLD, { left: -1, top: -1, right: 4, bottom: 3 }, 9).cells],
    [9, 9, 9, 9, 9, 9, 1, 2, 3, 9, 9, 4, 5, 6, 9, 9, 9, 9, 9, 9],
  );
  assert.deepEqual(
    [...resized(OLD, { left: 5, top: 5, right: 7, bottom: 6 }, 9).cells],
    [9, 9],
    "a part that has nothing of the old one",
  );
});

test("what stays lies where it was, in a map that is turned as well", () => {
  for (const yaw of [0, 0.7]) {
    const frame = { width: 3, height: 2, resolution: 0.5, origin: [-3, 2, yaw] };
    const box = { left: -2, top: 1, right: 3, bottom: 4 };
    const after = { width: 5, height: 3, resolution: 0.5, origin: originOf(frame, box) };
    const [x, y] = toMetres(frame, [1, 1.5]);
    const [u, v] = toMetres(after, [3, 0.5]);
    assert.ok(Math.hypot(x - u, y - v) < 1e-8);
  }
});

test("what is unknown around a map is found", () => {
  const kinds = kindsOf([0, 100, -1]);
  const cells = Uint8Array.from([2, 2, 2, 2, 2, 0, 1, 2, 2, 2, 0, 2, 2, 2, 2, 2]);
  assert.deepEqual(boxWithout({ width: 4, height: 4, cells }, kinds, 2), { left: 1, top: 1, right: 3, bottom: 3 });
  assert.equal(boxWithout({ width: 4, height: 4, cells: new Uint8Array(16).fill(2) }, kinds, 2), null);
});

test("corners give whole cells, one at least", () => {
  assert.deepEqual(boxBetween([3.4, 5.6], [-1.2, 5.7]), { left: -1, top: 6, right: 3, bottom: 7 });
});

test("a new size is a step between strokes, and all of it is taken back and done again", () => {
  const { map, told } = opened([0, 0, 0]);
  const before = map.grid.cells.slice();
  map.stroke("a", "occupied", (fill) => fill(0, 0, 1));
  map.resize("b", { left: -1, top: 0, right: 3, bottom: 3 }, "unknown");
  map.stroke("c", "free", (fill) => fill(2, 0, 4));
  assert.deepEqual([...map.grid.cells], [2, 1, 1, 0, 2, 0, 0, 1, 0, 0, 0, 0]);
  assert.deepEqual([map.frame.width, map.frame.height, map.frame.origin], [4, 3, [-0.5, -0.5, 0]]);
  for (let i = 0; i < 3; i++) map.history.undo();
  assert.deepEqual(map.grid.cells, before);
  assert.deepEqual([map.frame.width, map.frame.height, map.frame.origin], [3, 2, [0, 0, 0]]);
  for (let i = 0; i < 3; i++) map.history.redo();
  assert.deepEqual([...map.grid.cells], [2, 1, 1, 0, 2, 0, 0, 1, 0, 0, 0, 0]);
  assert.equal(told.sizes, 3);
});

test("a map beyond the limit is refused, and the same size is no step", () => {
  const { map } = opened([0, 0, 0]);
  assert.throws(
    () => map.resize("a", { left: 0, top: 0, right: 11, bottom: 10 }, "free"),
    /11 × 10 cells; allowed: 100 in all/,
  );
  map.resize("a", { left: 0, top: 0, right: 3, bottom: 2 }, "free");
  assert.equal(map.history.canUndo, false);
});
