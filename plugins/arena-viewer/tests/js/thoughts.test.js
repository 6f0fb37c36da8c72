// How strongly ways are drawn, and what contacts and beams meet.

import assert from "node:assert/strict";
import { test } from "node:test";

import { touched } from "arena/facts.js";
import { bodiesOf } from "arena/people.js";
import { strengths } from "arena/thoughts.js";

const way = (/** @type {number} */ cost) => ({ points: [], cost, chosen: false });

test("the cheapest way is the strongest, refused and unknown ones are not", () => {
  assert.deepEqual(strengths([way(2), way(4), way(3), way(Infinity), way(NaN)]), [1, 0, 0.5, 0, 0]);
  assert.deepEqual(strengths([way(2)]), [1]);
});

test("beams meet legs where there are any", () => {
  const person = { x: 1, y: 2, vx: 0, vy: 0, radius: 0.3, state: 1, legs: null };
  assert.deepEqual(bodiesOf([person]), [person]);
  assert.equal(bodiesOf([{ ...person, legs: [1, 2, 3, 4, 0.06] }]).length, 2);
});

test("contacts are told in words", () => {
  assert.equal(touched({ kind: "person", speed: 0.5, caused: true }), "hits a person at 0.50 m/s");
  assert.equal(touched({ kind: "obstacle", speed: NaN, caused: false }), "is hit by an obstacle");
});
