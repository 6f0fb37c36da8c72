import assert from "node:assert/strict";
import { test } from "node:test";
import { Furniture } from "../../src/arena_studio/web/map/furniture.js";

const MAP = "maps/hall/map.yaml";
const FILE = { path: "maps/hall/map_furnished.json", version: "1", problems: [{ name: "first", furniture: [] }] };

/** Furniture whose requests are answered when the test says so. */
function setUp() {
  /** @type {{what: string, answer: (value: any) => void}[]} */ const asked = [];
  const ask = (what) => new Promise((answer) => void asked.push({ what, answer }));
  const api = { get: ask, post: (path) => ask(path), put: ask };
  const furniture = new Furniture(
    { api, ask: async () => null },
    () => null,
    () => {},
    () => {},
  );
  furniture.kinds = { table: [] };
  /** Answer the oldest request of this beginning. @param {string} beginning @param {unknown} value */
  const answer = async (beginning, value) => {
    const at = asked.findIndex(({ what }) => what.startsWith(beginning));
    assert.notEqual(at, -1, `no one asked for ${beginning}`);
    asked.splice(at, 1)[0].answer(value);
    await new Promise((done) => setImmediate(done));
  };
  return { furniture, answer };
}

test("the first file of a map is opened, or the one that is named", async () => {
  for (const [path, opened] of [
    ["", "a.json"],
    ["b.json", "b.json"],
  ]) {
    const { furniture, answer } = setUp();
    const loaded = furniture.load(MAP, path);
    await new Promise((done) => setImmediate(done));
    await answer("/api/maps/scenarios", { files: ["a.json", "b.json"].map((one) => ({ ...FILE, path: one })) });
    await loaded;
    assert.equal(furniture.file?.path, opened);
  }
});

test("a load that another one has overtaken opens nothing", async () => {
  const { furniture, answer } = setUp();
  const kept = furniture.load(MAP);
  const created = furniture.create(MAP, FILE.path);
  await answer("/api/maps/scenarios", {}); // the new file was written
  await answer("/api/maps/scenarios", { files: [FILE] }); // of the load before
  await kept;
  assert.equal(furniture.file, null);
  await answer("/api/maps/scenarios", { files: [FILE] });
  await created;
  assert.equal(furniture.file?.path, FILE.path);
});

test("pieces that no file has yet give way to a map that was opened meanwhile", async () => {
  const { furniture, answer } = setUp();
  const drawn = furniture.loose([{ kind: "table", pose: [1, 2, 0] }]);
  const opened = furniture.load(MAP);
  await new Promise((done) => setImmediate(done));
  await answer("/api/maps/scenarios", { files: [FILE] });
  await Promise.all([drawn, opened]);
  assert.deepEqual([furniture.file?.path, furniture.pieces], [FILE.path, []]);
});
