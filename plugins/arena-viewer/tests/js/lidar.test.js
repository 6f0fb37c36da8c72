import assert from "node:assert/strict";
import { test } from "node:test";

import { cast, rangesOf } from "arena/lidar.js";

const LIDAR = { beams: 4, angle_min: 0, angle_increment: Math.PI / 2, range_max: 10, mount: { x: 0, y: 0, theta: 0 } };
const SQUARE = [
  [2, -1],
  [3, -1],
  [3, 1],
  [2, 1],
];
const moment = {
  row: 0,
  time: 1,
  pose: [0, 0, 0],
  people: [{ x: 0, y: 4, radius: 0.5, legs: null }],
  team: [[0, -5, 0]],
};
/** @param {boolean} open @returns {any} */
const episode = (open) => ({
  said: {
    robot: { lidar: LIDAR, footprint: { vertices_xy: [], radius: 0.5 } },
    obstacles: [{ vertices_xy: [[-3, 0]], radius: 1 }],
    doors: [SQUARE],
  },
  map: null,
  scan: () => null,
  doorOpen: () => open,
});

test("a beam ends at the nearest side of a polygon, and passes where there is none", () => {
  const sides = [
    [2, -1, 2, 1],
    [3, -1, 3, 1],
  ];
  assert.deepEqual([...cast(null, [0, 0, 0], LIDAR, [], sides)], [2, Infinity, Infinity, Infinity]);
  assert.deepEqual([...cast(null, [0, 1.5, 0], LIDAR, [], sides)], [Infinity, Infinity, Infinity, Infinity]);
});

test("beams cast again meet people, obstacles, closed doors and teammates", () => {
  assert.deepEqual([...rangesOf(episode(false), /** @type {any} */ (moment))], [2, 3.5, 2, 4.5]);
  assert.deepEqual([...rangesOf(episode(true), /** @type {any} */ (moment))], [Infinity, 3.5, 2, 4.5]);
});
