import assert from "node:assert/strict";
import { test } from "node:test";
import { AGAIN, Autosave, COPY, THEIRS, WITHIN } from "../../src/arena_studio/web/edit/autosave.js";

/** A clock whose timers run when told to. */
function handClock() {
  /** @type {{act: () => void, ms: number}[]} */ const timers = [];
  return {
    timers,
    set: (act, ms) => {
      const timer = { act, ms };
      timers.push(timer);
      return timer;
    },
    clear: (timer) => void timers.splice(timers.indexOf(timer), 1),
    async ring() {
      timers.shift()?.act();
      await new Promise((done) => setImmediate(done));
    },
  };
}

/** @param {Partial<import("../../src/arena_studio/web/edit/autosave.js").Owner>} [own] */
function setUp(own = {}) {
  const clock = handClock();
  /** @type {string[]} */ const states = [];
  const owner = {
    save: async (version) => `${version}+`,
    theirs: async () => {},
    copy: async () => {},
    ask: async () => null,
    tell: (state) => void states.push(state),
    ...own,
  };
  return { clock, states, owner, autosave: new Autosave(owner, "v", clock) };
}

const failing = (status) => async () => {
  throw Object.assign(new Error("the reason"), { status });
};

test("many changes are one save, soon after the first", async () => {
  const { clock, states, autosave } = setUp();
  autosave.change();
  autosave.change();
  assert.deepEqual(
    clock.timers.map((timer) => timer.ms),
    [WITHIN],
  );
  assert.ok(WITHIN < 1000);
  await clock.ring();
  assert.equal(autosave.version, "v+");
  assert.deepEqual(states, ["changed", "changed", "saving", "saved"]);
});

test("what changes during a save is saved after it", async () => {
  let finish = () => {};
  const { clock, autosave } = setUp({ save: (version) => new Promise((done) => (finish = () => done(`${version}+`))) });
  autosave.change();
  await clock.ring();
  autosave.change();
  finish();
  await new Promise((done) => setImmediate(done));
  assert.equal(clock.timers.length, 1);
  await clock.ring();
  finish();
  await new Promise((done) => setImmediate(done));
  assert.equal(autosave.version, "v++");
  assert.equal(autosave.unsaved, false);
});

test("a server that is away is asked again and again, and then has everything", async () => {
  const { clock, owner, autosave } = setUp({ save: failing(undefined) });
  autosave.change();
  await clock.ring();
  for (const ms of [...AGAIN, AGAIN.at(-1)]) {
    assert.equal(autosave.state, "away");
    assert.deepEqual(
      clock.timers.map((timer) => timer.ms),
      [ms],
    );
    await clock.ring();
  }
  owner.save = async () => "new";
  await clock.ring();
  assert.equal(autosave.state, "saved");
  assert.equal(autosave.version, "new");
});

test("what the server refuses is told and tried again after the next change only", async () => {
  const { clock, autosave } = setUp({ save: failing(400) });
  autosave.change();
  await clock.ring();
  assert.equal(autosave.state, "refused");
  assert.equal(clock.timers.length, 0);
  autosave.change();
  assert.equal(clock.timers.length, 1);
});

test("a conflict asks, and saves nothing until it is settled", async () => {
  let saves = 0;
  const { clock, autosave } = setUp({ save: async () => ((saves += 1), failing(409)()) });
  autosave.change();
  await clock.ring();
  autosave.change();
  await autosave.flush();
  assert.equal(autosave.state, "conflict");
  assert.equal(saves, 1);
  assert.equal(clock.timers.length, 0);
});

for (const [choice, name] of [
  [THEIRS, "theirs"],
  [COPY, "copy"],
]) {
  test(`a conflict can be settled by ${name}`, async () => {
    let settled = "";
    const { clock, owner, autosave } = setUp({ save: failing(409), ask: async () => choice });
    owner[name] = async () => {
      settled = name;
      autosave.loaded("other");
    };
    autosave.change();
    await clock.ring();
    assert.equal(settled, name);
    assert.deepEqual([autosave.state, autosave.version, autosave.unsaved], ["saved", "other", false]);
  });
}

test("closing saves what is left", async () => {
  const { clock, autosave } = setUp();
  autosave.change();
  assert.equal(await autosave.close(), true);
  assert.equal(autosave.version, "v+");
  autosave.change();
  assert.equal(clock.timers.length, 0);
});
