import assert from "node:assert/strict";
import { test } from "node:test";
import { roundStep, toAngle, toGrid, toPoint } from "../../src/arena_studio/web/edit/snap.js";

test("points go to the nearest crossing of a grid, which may lie off the origin", () => {
  assert.deepEqual(toGrid([1.1, -0.6], 0.5), [1, -0.5]);
  assert.deepEqual(toGrid([1.1, -0.6], 1, [0.25, 0.25]), [1.25, -0.75]);
  assert.deepEqual(toGrid([1.1, -0.6], 0), [1.1, -0.6]);
});

test("points go to the nearest other point within reach", () => {
  assert.deepEqual(
    toPoint(
      [0, 0],
      [
        [0.3, 0],
        [0.2, 0.1],
      ],
      0.5,
    ),
    [0.2, 0.1],
  );
  assert.equal(toPoint([0, 0], [[1, 0]], 0.5), null);
});

test("lines turn to eighths", () => {
  const [x, y] = toAngle([1, 1], [3, 1.2]);
  assert.ok(Math.abs(x - 3) < 1e-9 && Math.abs(y - 1) < 1e-9);
  const [u, v] = toAngle([0, 0], [2, 1.8]);
  assert.ok(Math.abs(u - v) < 1e-9 && Math.abs(u - 1.9) < 1e-9);
});

test("steps of a grid are round", () => {
  assert.deepEqual(
    [0.03, 0.05, 0.2, 0.21, 7].map((least) => Number(roundStep(least).toPrecision(6))),
    [0.05, 0.05, 0.2, 0.5, 10],
  );
});
