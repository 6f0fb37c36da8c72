// What stands above the slider, and the way out that is drawn.

import assert from "node:assert/strict";
import { test } from "node:test";

import { decode } from "arena/decode.js";
import { Episode } from "arena/episode.js";
import { marksOf, nextMark } from "arena/marks.js";

import { document } from "./made.js";

const made = () => {
  const { maps, episodes } = decode(document());
  return new Episode(episodes[0], maps);
};

test("contacts and last avoidable moments are marks, in order, and hold-ups are none", () => {
  assert.deepEqual(
    marksOf([made()]).map(({ stamp, type, title }) => [stamp, type, title]),
    [
      [0.5, "moment", "0.5 s: until here"],
      [1, "contact", "1.0 s: is hit by a person at 0.50 m/s"],
    ],
  );
});

test("of several episodes a mark says whose it is", () => {
  assert.equal(marksOf([made(), made()])[0].title, "made: 0.5 s: until here");
});

test("keys go from mark to mark, and stay where there is none", () => {
  const marks = marksOf([made()]);
  assert.deepEqual(
    [0, 0.5, 1].map((time) => nextMark(marks, time, 1)),
    [0.5, 1, 1],
  );
  assert.deepEqual(
    [2, 1, 0.5].map((time) => nextMark(marks, time, -1)),
    [1, 0.5, 0.5],
  );
});

test("a way out is shown from a second before its moment to its own end", () => {
  const shown = (/** @type {number} */ time) => made().wayOut(time).length;
  assert.deepEqual([-0.6, -0.5, 0.5, 1, 1.1].map(shown), [0, 3, 3, 3, 0]);
});

test("an episode about which nothing was found has no moments", () => {
  const { maps, episodes } = decode(document());
  delete episodes[0].marks;
  const bare = new Episode(episodes[0], maps);
  assert.deepEqual([bare.moments, bare.wayOut(0.5)], [[], []]);
});
