// Legs, against the facts of a gait.

import assert from "node:assert/strict";
import { test } from "node:test";

import { legsOf, settle, stepLength, walk } from "arena/walk.js";

const gait = {
  leg_radius: 0.06,
  stance_width: 0.2,
  step_width: 0.1,
  step_width_from: 1,
  walk_ratio: 0.006,
  apart: 1,
  settling: 0.3,
};

test("legs are equally far ahead and behind, and within the body", () => {
  for (let steps = 0; steps < 4; steps += 0.1) {
    const [lx, ly, rx, ry, leg] = legsOf(gait, 3, 4, 0.3, [0.8, 0.6], steps);
    assert.ok(Math.abs((lx + rx) / 2 - 3) < 1e-12 && Math.abs((ly + ry) / 2 - 4) < 1e-12);
    assert.ok(Math.hypot(lx - 3, ly - 4) + leg <= 0.3 + 1e-12);
  }
});

test("a foot on the ground stays where it is while the body moves on", () => {
  const speed = 0.5;
  const length = stepLength(gait, speed);
  const at = (/** @type {number} */ steps) => legsOf(gait, steps * length, 0, 1, [speed, 0], steps);
  assert.ok(Math.abs(at(0.2)[0] - at(0.8)[0]) < 1e-12); // the left foot, from an even number of steps on
  assert.ok(Math.abs(at(1.2)[2] - at(1.8)[2]) < 1e-12); // then the right one
});

test("who stands keeps looking somewhere", () => {
  let velocity = [0, 1];
  for (let i = 0; i < 1000; i++) velocity = settle(gait, velocity, [0, 0], 0.1);
  assert.ok(Math.abs(velocity[1] - 1e-4) < 1e-12);
});

test("legs are as many as there are rows, none while no one is there", () => {
  const places = [
    [NaN, NaN],
    [0, 0],
    [0.1, 0],
    [NaN, NaN],
  ]; // rows
  const legs = /** @type {Float32Array} */ (walk(gait, [0, 0.1, 0.2, 0.3], (row) => places[row], 0.3, [0, 0]));
  assert.deepEqual(
    [0, 1, 2, 3].map((row) => Number.isNaN(legs[5 * row])),
    [true, false, false, true],
  );
  assert.equal(
    walk(gait, [0], () => [0, 0], 0.3, [NaN, NaN]),
    null,
  );
});
