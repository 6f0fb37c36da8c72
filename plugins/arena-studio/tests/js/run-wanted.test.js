// What the pages Run and Results hold, without a browser.

import assert from "node:assert/strict";
import { test } from "node:test";

import { allow, read, sort, written } from "../../src/arena_studio/web/results/asked.js";
import { change, choose, duration, nothing, ofScenario, restored } from "../../src/arena_studio/web/run/wanted.js";

test("options and values that are emptied leave nothing behind", () => {
  const wanted = change(choose(nothing(), "planner", ["dwa", "", "teb", "dwa"]), "episodes", " 4 ");
  assert.deepEqual(wanted.choices, { planner: ["dwa", "teb"] });
  assert.deepEqual(wanted.values, { episodes: "4" });
  assert.deepEqual(change(choose(wanted, "planner", [""]), "episodes", " "), nothing());
});

test("what was kept over a reload comes back, and anything else is nothing", () => {
  const wanted = choose(nothing(), "robot", ["jackal"]);
  assert.deepEqual(restored(JSON.stringify(wanted)), wanted);
  for (const text of [null, "", "{", "3", "{}", '{"choices": {"a": 1}, "values": {}, "more": "", "folder": ""}'])
    assert.deepEqual(restored(text), nothing());
});

test("a scenario file is driven once a scene on its map, by the planners that were chosen", () => {
  const before = choose(change(nothing(), "seed", "3"), "planner", ["dwa"]);
  const wanted = ofScenario(before, "scenarios/a.json", "maps/hall/map.yaml", "4");
  assert.deepEqual(wanted.choices, { planner: ["dwa"], task: ["scenario"], world: ["ros_map"] });
  const path = { "task.path": "scenarios/a.json", "world.path": "maps/hall/map.yaml" };
  assert.deepEqual(wanted.values, { seed: "3", episodes: "4", ...path });
  assert.deepEqual(ofScenario(before, "a.json", "", "1").choices, { planner: ["dwa"], task: ["scenario"] });
});

test("durations are said in the unit that one would use", () => {
  assert.deepEqual([3.4, 89, 600, 9000].map(duration), ["3 s", "89 s", "10 min", "2.5 h"]);
});

test("filters, words, order and page stand in the address", () => {
  const asked = {
    allowed: { preset: ["dwa", "teb"], run: ["a b/c&d"] },
    text: "ü=1",
    order: "time_to_goal",
    falling: true,
    page: 3,
  };
  assert.deepEqual(read(new URLSearchParams(written(asked))), asked);
  assert.deepEqual(read(new URLSearchParams("page=-3&nothing=1")), {
    allowed: {},
    text: "",
    order: "",
    falling: false,
    page: 0,
  });
});

test("a value is allowed once, and a column without values does not filter", () => {
  const asked = allow(allow(read(new URLSearchParams("page=2")), "robot", "jackal", true), "robot", "jackal", true);
  assert.deepEqual([asked.allowed, asked.page], [{ robot: ["jackal"] }, 0]);
  assert.deepEqual(allow(asked, "robot", "jackal", false).allowed, {});
});

test("a column is sorted rising, falling, and not at all", () => {
  const first = sort(read(new URLSearchParams()), "episode");
  const second = sort(first, "episode");
  assert.deepEqual(
    [first, second, sort(second, "episode")].map(({ order, falling }) => [order, falling]),
    [
      ["episode", false],
      ["episode", true],
      ["", false],
    ],
  );
});
