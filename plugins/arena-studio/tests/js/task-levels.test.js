import assert from "node:assert/strict";
import { test } from "node:test";
import { boundsOf } from "studio/task/parameters.js";
import { changed, COLUMNS, course, inserted, removed, shifted, steps } from "studio/task/levels.js";

const levels = [
  { difficulty: null, obstacles: 0, pedestrians: 0, pedestrian_speed: 0.3, speed_share: 0.5, min_distance: 3 },
  { difficulty: 0.5, obstacles: 2, pedestrians: 4, pedestrian_speed: 0.3, speed_share: 1 },
];

test("a new level is like the one before it", () => {
  assert.deepEqual(inserted(levels, 2)[2], levels[1]);
  assert.equal(inserted([], 0)[0].speed_share, 1);
});

test("levels are removed and change places", () => {
  assert.deepEqual(removed(levels, 0), [levels[1]]);
  assert.deepEqual(shifted(levels, 0, 1), [levels[1], levels[0]]);
  assert.equal(shifted(levels, 0, -1), levels);
});

test("a distance that is left open leaves the file, a difficulty becomes null", () => {
  assert.ok(!("min_distance" in changed(levels, 0, "min_distance", null)[0]));
  assert.equal(changed(levels, 1, "difficulty", null)[1].difficulty, null);
  assert.equal(changed(levels, 1, "obstacles", 7)[1].obstacles, 7);
  assert.equal(levels[1].obstacles, 2);
});

test("a plot has gaps where a level leaves a column open", () => {
  const difficulty = course(levels, COLUMNS[0]);
  assert.deepEqual(difficulty.values, [null, 0.5]);
  assert.deepEqual(steps(difficulty.values, difficulty.most), [
    [
      [0.5, 0.5],
      [1, 0.5],
    ],
  ]);
  assert.equal(course(levels, COLUMNS[2]).most, 4);
});

test("bounds are read from what the form says", () => {
  assert.deepEqual(boundsOf("0 .. 1"), ["0", "1"]);
  assert.deepEqual(boundsOf(">= 0 and <= 1000"), ["0", "1000"]);
  assert.deepEqual(boundsOf("> 0"), ["0", ""]);
  assert.deepEqual(boundsOf(""), ["", ""]);
});
