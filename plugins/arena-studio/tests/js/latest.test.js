import assert from "node:assert/strict";
import { test } from "node:test";
import { latest } from "../../src/arena_studio/web/edit/latest.js";

test("what was begun last is wanted, all before is not", () => {
  const [opening, laying] = [latest(), latest()];
  const first = opening();
  assert.equal(first(), true);
  const other = laying();
  const second = opening();
  assert.deepEqual([first(), second(), other()], [false, true, true]);
});
