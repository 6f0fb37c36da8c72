// Where a canvas looks.

import assert from "node:assert/strict";
import { test } from "node:test";

import { Camera, windowOf } from "arena/camera.js";
import { decode } from "arena/decode.js";
import { Episode } from "arena/episode.js";

import { document } from "./made.js";

const pane = { x: 10, y: 20, width: 400, height: 200 };
const near = (/** @type {number[]} */ found, /** @type {number[]} */ wanted) =>
  found.forEach((value, i) => assert.ok(Math.abs(value - wanted[i]) < 1e-9));

test("y of the map goes up, and a pane's middle shows the camera's place", () => {
  const camera = new Camera();
  near(camera.point(pane, 210, 120), [0, 0]);
  near(camera.point(pane, 250, 80), [1, 1]);
});

test("a window fits by its narrower side", () => {
  const camera = new Camera();
  camera.fit([0, 4, 0, 10], 400, 200);
  assert.equal(camera.scale, 0.96 * 20);
  assert.deepEqual([camera.x, camera.y], [2, 5]);
});

test("zooming keeps the point under the pointer, and has ends", () => {
  const camera = new Camera();
  const before = camera.point(pane, 60, 50);
  camera.zoom(3, pane, 60, 50);
  near(camera.point(pane, 60, 50), before);
  camera.zoom(1e9, pane, 60, 50);
  assert.equal(camera.scale, 2000);
});

test("what is dragged stays under the hand", () => {
  const camera = new Camera();
  const before = camera.point(pane, 100, 100);
  camera.pan(30, -10);
  near(camera.point(pane, 130, 90), before);
});

test("free cells and a margin are shown", () => {
  const { maps, episodes } = decode(document());
  near(windowOf(new Episode(episodes[0], maps)), [-0.5 - 0.6, 0.5 + 0.6, -2 - 0.6, 0.6]);
});
