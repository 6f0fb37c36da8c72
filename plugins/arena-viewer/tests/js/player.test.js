// The time that is shown.

import assert from "node:assert/strict";
import { test } from "node:test";

import { Player } from "arena/player.js";

test("time runs at the chosen speed and stops at the end", () => {
  const player = new Player(10, 0.1);
  player.advance(1);
  assert.equal(player.time, 0);
  player.toggle();
  player.faster(1);
  player.advance(1);
  assert.equal(player.time, 2);
  player.advance(100);
  assert.deepEqual([player.time, player.playing], [10, false]);
});

test("playing at the end begins again", () => {
  const player = new Player(10, 0.1);
  player.seek(99);
  assert.equal(player.time, 10);
  player.toggle();
  assert.deepEqual([player.time, player.playing], [0, true]);
});

test("steps are control steps, and stop playing", () => {
  const player = new Player(10, 0.25);
  player.toggle();
  player.seek(1.1);
  player.stepBy(1);
  assert.deepEqual([player.time, player.playing], [1.25, false]);
  player.stepBy(-100);
  assert.equal(player.time, 0);
});

test("speeds end at a quarter and at sixteen times", () => {
  const player = new Player(10, 0.1);
  for (let i = 0; i < 20; i++) player.faster(1);
  assert.equal(player.speed, 16);
  for (let i = 0; i < 20; i++) player.faster(-1);
  assert.equal(player.speed, 0.25);
});

test("who listens is told", () => {
  const player = new Player(10, 0.1);
  let told = 0;
  player.listen(() => told++);
  player.seek(1);
  player.advance(1); // does not play
  assert.equal(told, 1);
});
