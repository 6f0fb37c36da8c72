import assert from "node:assert/strict";
import test from "node:test";
import { doorEntries } from "studio/scenario/fields.js";
import { handleAt, handlesOf, inside, moved } from "studio/scenario/handles.js";
import {
  added,
  freeName,
  newContent,
  newScene,
  relativePath,
  thingOf,
  things,
  titleOf,
  valueOf,
  withScene,
  withValue,
  without,
} from "studio/scenario/model.js";
import { leaf } from "studio/scenario/tools.js";
import { withZone, withoutZone, zonesOf } from "studio/scenario/zones.js";

const person = {
  position: /** @type {[number, number]} */ ([5, 5]),
  waypoints: /** @type {[number, number][]} */ ([
    [5, 8],
    [7, 8],
  ]),
  radius: 0.3,
};
const scene = {
  ...newScene("a"),
  pedestrians: [person],
  obstacles: [
    { center: [2, 4], radius: 0.5 },
    {
      vertices: [
        [8, 8],
        [9, 8],
        [9, 9],
        [8, 9],
      ],
    },
  ],
};

test("a scene is never changed in place", () => {
  const frozen = structuredClone(scene);
  without(scene, { kind: "obstacles", index: 0 });
  withValue(scene, { kind: "pedestrians", index: 0 }, { position: [0, 0] });
  moved(scene, handlesOf(scene, { kind: "pedestrians", index: 0 }, true)[0], [1, 1]);
  added(scene, "furniture", { kind: "table", pose: [1, 1, 0] });
  assert.deepEqual(scene, frozen);
});

test("things are start, goal and all that the lists hold", () => {
  assert.deepEqual(
    things(scene).map(({ kind, index }) => `${kind} ${index}`),
    ["start 0", "goal 0", "pedestrians 0", "obstacles 0", "obstacles 1"],
  );
  assert.equal(things(without(scene, { kind: "obstacles", index: 0 })).length, 4);
  assert.equal(without(scene, { kind: "goal", index: 0 }), scene);
});

test("a key of the file names its thing", () => {
  assert.deepEqual(thingOf("scenarios[1].pedestrians[3].position"), { kind: "pedestrians", index: 3 });
  assert.deepEqual(thingOf("scenarios[0].start"), { kind: "start", index: 0 });
  assert.equal(thingOf("scenarios[0].name"), null);
});

test("the handle under the pointer is the nearest, and the chosen thing's goes first", () => {
  assert.equal(handleAt(scene, [5.2, 5], 0.1, null)?.part, "place");
  assert.equal(handleAt(scene, [5.02, 8.02], 0.1, null)?.part, "waypoint");
  assert.deepEqual(handleAt(scene, [8.2, 8.2], 0.1, null)?.thing, { kind: "obstacles", index: 1 });
  assert.equal(handleAt(scene, [8.02, 8.02], 0.1, { kind: "obstacles", index: 1 })?.part, "corner");
  assert.equal(handleAt(scene, [3, 9], 0.1, null), null);
});

test("a polygon moves as a whole, a disc's rim gives its radius, a heading turns", () => {
  const polygon = handlesOf(scene, { kind: "obstacles", index: 1 }, false)[0];
  assert.deepEqual(moved(scene, polygon, [9.5, 8.5]).obstacles?.[1].vertices, [
    [9, 8],
    [10, 8],
    [10, 9],
    [9, 9],
  ]);
  const rim = handlesOf(scene, { kind: "obstacles", index: 0 }, true).find(({ part }) => part === "rim");
  assert.equal(moved(scene, /** @type {any} */ (rim), [2, 5]).obstacles?.[0].radius, 1);
  const heading = handlesOf(scene, { kind: "start", index: 0 }, true).find(({ part }) => part === "heading");
  assert.deepEqual(moved(scene, /** @type {any} */ (heading), [1, 9]).start, [1, 1, 1.571]);
});

test("zones are told as the model of people reads them", () => {
  assert.deepEqual(zonesOf(person), []);
  const one = withZone(person, { number: 0, x: 5, y: 5, radius: 2 });
  const two = withZone(one, { number: 0, x: 1, y: 2, radius: 1 });
  assert.deepEqual(
    zonesOf(two).map(({ number, x, radius }) => [number, x, radius]),
    [
      [1, 5, 2],
      [2, 1, 1],
    ],
  );
  assert.equal(two.behaviour?.trigger_zone_2_y, 2);
  const none = withoutZone(withoutZone(two, 1), 2);
  assert.deepEqual(none.behaviour, {});
});

test("a zone around a person is moved with its own handle", () => {
  const with_zone = { ...scene, pedestrians: [withZone(person, { number: 1, x: 6, y: 5, radius: 2 })] };
  const zone = handlesOf(with_zone, { kind: "pedestrians", index: 0 }, true).find(({ part }) => part === "zone");
  const after = moved(with_zone, /** @type {any} */ (zone), [1, 1]);
  assert.deepEqual(zonesOf(/** @type {any} */ (after.pedestrians)[0])[0], { number: 1, x: 1, y: 1, radius: 2 });
});

test("names are free, and paths lead from a file to its map", () => {
  assert.equal(freeName("a", ["b"]), "a");
  assert.equal(freeName("a", ["a", "a 2"]), "a 3");
  assert.equal(relativePath("scenes/x/a.json", "scenes/maps/m.yaml"), "../maps/m.yaml");
  assert.equal(relativePath("a.json", "maps/m.yaml"), "maps/m.yaml");
});

test("content holds scenes in their order", () => {
  const content = newContent([newScene("a"), newScene("b")], "maps/m.yaml");
  const after = withScene(content, 1, { ...content.scenarios[1], name: "c" });
  assert.deepEqual(
    after.scenarios.map(({ name }) => name),
    ["a", "c"],
  );
  assert.equal(valueOf(after.scenarios[0], { kind: "start", index: 0 })[0], 1);
  assert.equal(titleOf(scene, { kind: "pedestrians", index: 0 }), "Person 0");
  assert.ok(
    inside(
      [
        [0, 0],
        [2, 0],
        [2, 2],
      ],
      [1.5, 1],
    ),
  );
});

test("the doors of a file are kept by whatever is changed", () => {
  const doors = [
    {
      vertices: /** @type {[number, number][]} */ ([
        [1, 1],
        [2, 1],
        [2, 2],
      ]),
      open: [[3, 8]],
      period: 20,
    },
  ];
  const changed = without(added({ ...scene, doors }, "pedestrians", person), { kind: "obstacles", index: 0 });
  const shifted = withValue(changed, { kind: "start", index: 0 }, [3, 3, 0]);
  assert.deepEqual(withScene(newContent([scene]), 0, shifted).scenarios[0].doors, doors);
});

test("a door is drawn from post to post, taken by its leaf, and opens when its fields say", () => {
  const door = { vertices: leaf([4, 2], [4, 3]), open: [[5]] };
  assert.deepEqual(door.vertices, [
    [4.05, 2],
    [4.05, 3],
    [3.95, 3],
    [3.95, 2],
  ]);
  const with_door = added(scene, "doors", door);
  assert.deepEqual(handleAt(with_door, [4.02, 2.1], 0.01, null)?.thing, { kind: "doors", index: 0 });
  assert.equal(titleOf(with_door, { kind: "doors", index: 0 }), "Door 0");
  assert.deepEqual(thingOf("scenarios[0].doors[2].open"), { kind: "doors", index: 2 });
  const [opens, closes, again] = doorEntries(door);
  assert.deepEqual(opens.write(8).open, [[8]]);
  assert.deepEqual(closes.write(9).open, [[5, 9]]);
  assert.deepEqual(doorEntries(closes.write(9))[1].write(undefined).open, [[5]]);
  assert.equal(again.write(20).period, 20);
});
