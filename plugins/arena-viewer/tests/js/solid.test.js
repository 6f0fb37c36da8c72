import assert from "node:assert/strict";
import { test } from "node:test";

import { decode } from "arena/decode.js";
import { Episode, turned } from "arena/episode.js";
import { freeStanding, rectangles } from "arena/solid/building.js";
import { directionAt } from "arena/solid/eye.js";
import { walkOf } from "arena/solid/figures.js";
import { document } from "./made.js";

const MAP = ["111111", "1....1", "1.11.1", "1.11.1", "1....1", "111111"].join("");
const CELLS = Array.from(MAP, (letter) => (letter === "1" ? 1 : 0));

test("rectangles cover the wanted cells once each, and nothing else", () => {
  for (const wanted of [0, 1]) {
    const covered = new Array(36).fill(0);
    for (const [i, j, columns, rows] of rectangles(CELLS, 6, 6, (cell) => cell === wanted))
      for (let b = j; b < j + rows; b++) for (let a = i; a < i + columns; a++) covered[b * 6 + a] += 1;
    assert.deepEqual(
      covered,
      CELLS.map((cell) => (cell === wanted ? 1 : 0)),
    );
  }
  assert.equal(rectangles(CELLS, 6, 6).length, 5); // top, bottom, left, right, the block
});

test("what stands free is told from walls, unless it is large", () => {
  assert.equal(
    freeStanding(CELLS, 6, 6, 10).reduce((sum, one) => sum + one, 0),
    4,
  );
  assert.equal(
    freeStanding(CELLS, 6, 6, 4).reduce((sum, one) => sum + one, 0),
    0,
  );
});

test("who walks takes steps as long as the pace asks for, and looks where it goes", () => {
  const { steps, facing, stride } = walkOf([0, 1, 2, 3], (row) => [1.2 * row, 0]);
  const length = Math.sqrt(60 * 0.006 * 1.2);
  assert.ok(Math.abs(stride[2] - length) < 1e-6);
  assert.ok(Math.abs(steps[3] - 3.6 / length) < 1e-5);
  assert.deepEqual([...facing], [0, 0, 0, 0]);
});

test("who stands looks where it will go, who is gone takes no step", () => {
  const places = [
    [0, 0],
    [0, 0],
    [0, 1],
    [NaN, NaN],
  ];
  const { steps, facing, stride } = walkOf([0, 1, 2, 3], (row) => places[row]);
  assert.ok(Math.abs(facing[0] - Math.PI / 2) < 1e-6);
  assert.equal(stride[1], 0);
  assert.equal(steps[1], 0);
  assert.equal(stride[3], 0);
  assert.equal(steps[3], steps[2]);
});

test("a camera behind a robot turns with it, not by jerks", () => {
  const { maps, episodes } = decode(document());
  const episode = new Episode(episodes[0], maps);
  const apart = (/** @type {number} */ a, /** @type {number} */ b) => Math.abs(turned(0, a - b, 1));
  for (let time = 0.1; time < 1.9; time += 0.05)
    assert.ok(apart(directionAt(episode, time), directionAt(episode, time - 0.05)) < 0.3);
  assert.ok(apart(directionAt(episode, 1.9), -3.0) < 0.3);
});
