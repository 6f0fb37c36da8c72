// What the page of runs under way says.

import assert from "node:assert/strict";
import { test } from "node:test";

import { windowOfMap } from "arena/live_view.js";
import { duration, standing } from "arena/live_words.js";

const run = { number: 0, name: "run", rows: [], running: [] };

test("durations are told in the unit that fits", () => {
  assert.deepEqual([5, 600, 7200].map(duration), ["5 s", "10 min", "2.0 h"]);
});

test("how far the runs are is one line", () => {
  const state = { runs: [run], total: 10, done: 4, succeeded: 3, left: 30, workers: 2 };
  assert.equal(standing(state), "4 of 10 episodes · 3 succeeded · 2 workers at work · about 30 s left");
  assert.equal(
    standing({ ...state, left: null, workers: 0 }),
    "4 of 10 episodes · 3 succeeded · time left not known yet",
  );
  assert.equal(standing({ ...state, done: 10 }), "10 of 10 episodes · 3 succeeded · ended");
  assert.equal(standing({ ...state, runs: [] }), "waiting for the run to begin");
});

test("a map's free part is shown with a margin", () => {
  const map = { width: 3, height: 2, resolution: 1, origin: [0, 0, 0], cells: "100111" };
  assert.deepEqual(windowOfMap(map), [0.5, 3.5, -0.5, 1.5]);
});
