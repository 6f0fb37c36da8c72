import assert from "node:assert/strict";
import { test } from "node:test";
import { ago, extent, pointAt, short, ticks } from "studio/curves/scale.js";

test("ticks are round and lie within the interval", () => {
  assert.deepEqual(ticks(0, 1, 5), [0, 0.2, 0.4, 0.6, 0.8, 1]);
  assert.deepEqual(ticks(-0.34, 0.08, 5), [-0.3, -0.2, -0.1, 0]);
  assert.deepEqual(ticks(32768, 12e6, 6), [2e6, 4e6, 6e6, 8e6, 1e7, 1.2e7]);
  assert.deepEqual(ticks(3, 3, 5), [3]);
  assert.deepEqual(ticks(0, Infinity, 5), [0]);
});

test("numbers are short", () => {
  assert.deepEqual([0, 0.05, 744, 9999, 524288, 12e6, -2.34e-7].map(short), [
    "0",
    "0.05",
    "744",
    "9999",
    "524.3 k",
    "12 M",
    "-2.3e-7",
  ]);
});

test("an extent holds all that must be seen and is never without width", () => {
  assert.deepEqual(extent([0.2, 0.1], [0]), [0, 0.2]);
  assert.deepEqual(extent([4, 4]), [2, 6]);
  assert.deepEqual(extent([0]), [-0.5, 0.5]);
  assert.deepEqual(extent([NaN]), [0, 1]);
});

test("a line is read at its last point before a place", () => {
  const points = /** @type {[number, number][]} */ ([
    [1, 10],
    [2, 20],
    [4, 40],
  ]);
  assert.deepEqual(
    [0, 1, 3, 9].map((x) => pointAt(points, x)[1]),
    [10, 10, 20, 40],
  );
});

test("times are told in words", () => {
  assert.deepEqual([5, 60, 7300, 200000].map(ago), ["just now", "1 minute ago", "2 hours ago", "2 days ago"]);
});
