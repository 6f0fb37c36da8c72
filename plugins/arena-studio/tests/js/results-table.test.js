// Cells of the table of episodes: what one reads, not what is stored.

import assert from "node:assert/strict";
import test from "node:test";
import { shown } from "studio/results/table.js";

test("success is a word, and so is failure", () => {
  assert.deepEqual(
    ["success", "strict_success"].map((name) => [shown(name, 1), shown(name, 0), shown(name, null)]),
    [
      ["yes", "no", ""],
      ["yes", "no", ""],
    ],
  );
  assert.equal(shown("collisions", 1), "1");
});

test("run that is called after its time takes little room, one with a name keeps it", () => {
  assert.equal(shown("run", "outputs/2026-11-27/18-21-22-123456"), "11-27 18:21:22");
  assert.equal(shown("run", "multirun/2026-11-27/18-21-22/3"), "11-27 18:21:22/3");
  assert.equal(shown("run", "lab/dwa_hall"), "lab/dwa_hall");
});
