// An episode that is asked for moments.

import assert from "node:assert/strict";
import { test } from "node:test";

import { decode } from "arena/decode.js";
import { Episode, turned } from "arena/episode.js";

import { document } from "./made.js";

const made = () => {
  const { maps, episodes } = decode(document());
  return new Episode(episodes[0], maps);
};

test("the row that holds is the last at or before a time", () => {
  assert.deepEqual(
    [-1, 0, 0.99, 1, 1.5, 2, 9].map((time) => made().rowAt(time)),
    [0, 0, 0, 1, 1, 2, 2],
  );
});

test("poses move evenly between rows, headings the short way round", () => {
  const { pose } = made().at(0.5);
  assert.ok(Math.abs(pose[0] - 1) < 1e-6);
  assert.ok(Math.abs(Math.abs(pose[2]) - Math.PI) < 1e-6); // from 3 to -3 by way of pi
  assert.ok(Math.abs(turned(0.1, -0.1, 0.5)) < 1e-12);
});

test("people are those who are in the world", () => {
  assert.equal(made().at(0.5).people.length, 0);
  const [person] = made().at(1.5).people;
  assert.deepEqual([person.x, person.y, person.vx, person.state], [5.5, 1, 1, 1]);
});

test("teammates move evenly between rows, headings the short way round", () => {
  const [[x, y, theta]] = made().at(0.5).team;
  assert.deepEqual([x, y], [7, 1]);
  assert.ok(Math.abs(Math.abs(theta) - Math.PI) < 1e-6);
});

test("the path is the last that was planned", () => {
  assert.deepEqual(made().at(1).path, [
    [0, 0],
    [1, 0],
  ]);
  assert.deepEqual(made().at(1.6).path, [
    [0, 5],
    [9, 5],
  ]);
});

test("what the planner weighed and believed is that of the row", () => {
  assert.deepEqual(made().considered(0), []);
  const [chosen, refused] = made().considered(1);
  assert.deepEqual(chosen, {
    points: [
      [0, 0],
      [1, 0],
    ],
    cost: 3,
    chosen: true,
  });
  assert.deepEqual([refused.cost, refused.chosen], [Infinity, false]);
  assert.deepEqual(made().considered(2), []); // the last row, in which nothing is decided
  assert.deepEqual(made().tracks(0), [{ id: 7, x: 5, y: 1, vx: 1, vy: 0, radius: 0.25 }]);
  assert.deepEqual(made().tracks(1), []);
});

test("people whose lidars see legs have two", () => {
  const [person] = made().at(1).people;
  const [leftX, , rightX, , radius] = /** @type {number[]} */ (person.legs);
  assert.ok(Math.abs((leftX + rightX) / 2 - person.x) < 1e-6);
  assert.ok(Math.abs(radius - 0.06) < 1e-6);
});

test("contacts say what was touched", () => {
  const [contact] = made().contacts;
  assert.deepEqual(contact, { stamp: 1, x: 2, y: 0, kind: "person", speed: 0.5, caused: false });
});

test("contacts are those of the record", () => {
  assert.deepEqual(made().collisions, [1]);
  assert.equal(made().at(1).touching, true);
  assert.equal(made().scan(0), null);
});

test("a door is as it was at the row that holds", () => {
  const open = (/** @type {number} */ door) => [0, 0.9, 1, 2].map((time) => made().doorOpen(door, time));
  assert.deepEqual(open(0), [false, false, true, true]);
  assert.deepEqual(open(1), [true, true, true, false]);
});
