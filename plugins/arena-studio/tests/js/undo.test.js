import assert from "node:assert/strict";
import { test } from "node:test";
import { History } from "../../src/arena_studio/web/edit/undo.js";

/** @param {number[]} list @param {number} value */
const push = (list, value, bytes = 0) => ({
  label: `push ${value}`,
  bytes,
  do: () => void list.push(value),
  undo: () => void list.pop(),
});

test("undo and redo go back and forth", () => {
  const list = [];
  const history = new History();
  history.run(push(list, 1));
  history.run(push(list, 2));
  assert.equal(history.undo(), "push 2");
  assert.deepEqual(list, [1]);
  assert.equal(history.redo(), "push 2");
  assert.deepEqual(list, [1, 2]);
  assert.equal(history.redo(), "");
});

test("a new command forgets what was taken back", () => {
  const list = [];
  const history = new History();
  history.run(push(list, 1));
  history.undo();
  history.run(push(list, 2));
  assert.equal(history.canRedo, false);
  assert.deepEqual(list, [2]);
});

test("a group is one step, also inside another group, and an empty one is none", () => {
  const list = [];
  let changes = 0;
  const history = new History(() => (changes += 1));
  history.begin("stroke");
  history.run(push(list, 1));
  history.begin("inner");
  history.run(push(list, 2));
  history.run(push(list, 3));
  history.end();
  assert.equal(history.undo(), "", "nothing is taken back inside a group");
  history.end();
  history.begin("empty");
  history.end();
  assert.equal(changes, 1);
  assert.equal(history.undo(), "stroke");
  assert.deepEqual(list, []);
  history.redo();
  assert.deepEqual(list, [1, 2, 3]);
});

test("a cancelled group leaves nothing", () => {
  const list = [];
  const history = new History();
  history.begin("stroke");
  history.run(push(list, 1));
  history.run(push(list, 2));
  history.cancel();
  assert.deepEqual(list, []);
  assert.equal(history.canUndo, false);
});

test("the oldest steps are forgotten beyond the bounds, the last one never", () => {
  const list = [];
  const history = new History(undefined, { commands: 3, bytes: 100 });
  for (let i = 0; i < 5; i++) history.run(push(list, i, 10));
  assert.equal(history.done.length, 3);
  history.run(push(list, 9, 1000));
  assert.deepEqual(
    history.done.map((one) => one.label),
    ["push 9"],
  );
});
