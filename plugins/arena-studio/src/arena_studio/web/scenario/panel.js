// The panel beside the map: fields of what is chosen, or of the scene; what stands in it; what is wrong with it.

import {
  behaviourEntries,
  cornerEntries,
  doorEntries,
  entriesOf,
  otherEntries,
  sceneEntries,
  zoneEntries,
} from "studio/scenario/fields.js";
import { same, thingOf, things, titleOf, valueOf, withValue } from "studio/scenario/model.js";
import { remove } from "studio/scenario/tools.js";
import { button, make } from "studio/shell/forms.js";

/** @typedef {import("./editor.js").Editor} Editor */
/** @typedef {import("./fields.js").Entry} Entry */

/** @param {Editor} editor @param {(place: number[]) => void} look shows a place */
export function panels(editor, look) {
  const chosen = make("div", { className: "inside" });
  const head = make("summary", {}, "Scene");
  const list = make("ul", { className: "things", "aria-label": "what stands in the scene" });
  const wrong = make("ul", { className: "findings", "aria-label": "what is wrong", "aria-live": "polite" });
  const wrongHead = make("summary", {}, "Check");
  const parts = [part(wrongHead, wrong), part(head, chosen), part(make("summary", {}, "Things"), list)];
  let shown = "";
  return {
    elements: parts,
    show() {
      if (!editor.content) return;
      head.textContent = editor.chosen ? titleOf(editor.scene, editor.chosen) : `Scene “${editor.scene.name}”`;
      const now = JSON.stringify([
        editor.path,
        editor.at,
        editor.chosen,
        editor.chosen ? valueOf(editor.scene, editor.chosen) : sceneOnly(editor),
      ]);
      if (now !== shown)
        keepFocus(chosen, () => chosen.replaceChildren(...(editor.chosen ? thingFields(editor) : sceneFields(editor))));
      shown = now;
      list.replaceChildren(...things(editor.scene).map((thing) => thingRow(editor, thing, look)));
      wrongHead.textContent = headOf(editor);
      wrongHead.className = editor.findings.length ? "bad" : editor.checking === "checked" ? "good" : "";
      wrong.replaceChildren(...editor.findings.map((finding) => findingRow(editor, finding, look)));
    },
  };
}

/** @param {HTMLElement} head @param {HTMLElement} content */
function part(head, content) {
  const element = make("details", { className: "part", open: true }, head, content);
  return element;
}

/** @param {Editor} editor */
function sceneOnly(editor) {
  const { pedestrians: _p, obstacles: _o, furniture: _f, doors: _d, start: _s, goal: _g, ...own } = editor.scene;
  return own;
}

/** @param {Editor} editor */
function headOf(editor) {
  if (editor.checking !== "checked" && !editor.findings.length) return "Check: …";
  const count = editor.findings.length;
  return count ? `Check: ${count} ${count === 1 ? "problem" : "problems"}` : "Check: can be run";
}

/**
 * Rebuild a part and give the focus back to the field that had it.
 * @param {HTMLElement} place
 * @param {() => void} build
 */
function keepFocus(place, build) {
  const active = document.activeElement;
  const label = active instanceof HTMLElement && place.contains(active) ? active.dataset.entry : undefined;
  build();
  if (label)
    /** @type {HTMLElement | undefined} */ (
      [...place.querySelectorAll("[data-entry]")].find(
        (one) => /** @type {HTMLElement} */ (one).dataset.entry === label,
      )
    )?.focus();
}

/** @param {Editor} editor */
function sceneFields(editor) {
  const write = (/** @type {Entry} */ entry) => (/** @type {any} */ value) =>
    editor.change(`change ${entry.name}`, () => entry.write(value));
  return [
    make("div", { className: "pair" }, ...sceneEntries(editor.scene).map((entry) => fieldOf(entry, write(entry)))),
  ];
}

/** @param {Editor} editor */
function thingFields(editor) {
  const thing = /** @type {import("./model.js").Thing} */ (editor.chosen);
  const value = valueOf(editor.scene, thing);
  const set = (/** @type {string} */ label) => (/** @type {any} */ after) =>
    editor.change(label, (scene) => withValue(scene, thing, after));
  const field = (/** @type {Entry} */ entry) =>
    fieldOf(entry, (given) => set(`change ${entry.name}`)(entry.write(given)));
  const fields = make("div", { className: "pair" }, ...entriesOf(thing.kind, value, editor.kinds.furniture).map(field));
  const more =
    thing.kind === "pedestrians"
      ? personParts(editor, value, field, set)
      : thing.kind === "doors"
        ? doorParts(value, field, set)
        : [];
  const fixed = thing.kind === "start" || thing.kind === "goal";
  return [fields, ...more, ...(fixed ? [] : [button("Remove", () => remove(editor), { title: "Delete" })])];
}

/**
 * @param {Editor} editor
 * @param {import("./model.js").Person} person
 * @param {(entry: Entry) => HTMLElement} field
 * @param {(label: string) => (after: any) => void} set
 */
function personParts(editor, person, field, set) {
  const table = editor.kinds.behaviour;
  const ways = (person.waypoints ?? []).map((at, number) =>
    make(
      "div",
      { className: "line" },
      ...cornerEntries(person, "waypoints", at, number).map(field),
      small(`remove waypoint ${number}`, () => set("remove a waypoint")(withoutWay(person, number))),
    ),
  );
  const zones = zoneEntries(person).map(({ number, entries, without }) =>
    make(
      "div",
      { className: "line three" },
      ...entries.map(field),
      small(`remove zone ${number}`, () => set("remove a zone")(without())),
    ),
  );
  const own = behaviourEntries(person, table).filter(({ name }) => name !== "trigger zone radius");
  const first = own.slice(0, 5).map(field);
  return [
    make("div", { className: "pair" }, ...first),
    make("h2", {}, "Round"),
    ways.length
      ? make("div", { className: "stack" }, ...ways)
      : make("p", { className: "soft" }, "It stands. Waypoints make it walk: click the map with the tool “person”."),
    button("Add a waypoint", () => set("add a waypoint")(withWay(person)), { className: "quiet" }),
    ...(zones.length ? [make("h2", {}, "Zones that start it"), ...zones] : []),
    make(
      "details",
      {},
      make("summary", {}, "More of its behaviour"),
      make("div", { className: "pair" }, ...[...own.slice(5), ...otherEntries(person, table)].map(field)),
    ),
  ];
}

/**
 * @param {import("./model.js").Door} door
 * @param {(entry: Entry) => HTMLElement} field
 * @param {(label: string) => (after: any) => void} set
 */
function doorParts(door, field, set) {
  const last = door.open.at(-1) ?? [0];
  const more = [...door.open.slice(0, -1), [last[0], last[1] ?? last[0] + 5], [(last[1] ?? last[0] + 5) + 5]];
  const opening = button("Opens again", () => set("add an opening")({ ...door, open: more }), { className: "quiet" });
  const fewer = () => set("remove an opening")({ ...door, open: door.open.slice(0, -1) });
  return [
    make("h2", {}, "Open"),
    make("div", { className: "pair" }, ...doorEntries(door).map(field)),
    opening,
    ...(door.open.length > 1 ? [button("Remove the last opening", fewer, { className: "quiet" })] : []),
  ];
}

/** @param {import("./model.js").Person} person @param {number} number */
function withoutWay(person, number) {
  return { ...person, waypoints: (person.waypoints ?? []).filter((_, at) => at !== number) };
}

/** @param {import("./model.js").Person} person */
function withWay(person) {
  const [x, y] = person.waypoints?.at(-1) ?? person.position;
  return { ...person, waypoints: [...(person.waypoints ?? []), [x + 1, y]] };
}

/** @param {string} said @param {() => void} act */
function small(said, act) {
  return button("✕", act, { className: "quiet small", "aria-label": said, title: said });
}

/**
 * A field that writes when it is left, or as one chooses; what is out of bounds is not written.
 * @param {Entry} entry
 * @param {(value: any) => void} write
 */
export function fieldOf(entry, write) {
  const input = entry.choices ? choiceOf(entry, write) : inputOf(entry, write);
  input.dataset.entry = entry.name;
  const unit = entry.unit && entry.unit !== "-" ? ` (${entry.unit})` : "";
  return make(
    "label",
    { className: "field", title: entry.meaning ?? "" },
    make("span", {}, `${entry.name}${unit}`),
    input,
  );
}

/** @param {Entry} entry @param {(value: any) => void} write */
function choiceOf({ choices = [], names = [], value }, write) {
  const said = value === undefined ? "" : String(value);
  const all = choices.map(String).includes(said) || said === "" ? choices : [...choices, /** @type {string} */ (value)];
  const select = make(
    "select",
    {},
    new Option("–", ""),
    ...all.map((one, at) => new Option(names[at] ?? String(one), String(one))),
  );
  select.value = said;
  select.addEventListener("change", () => {
    const found = all.find((one) => String(one) === select.value);
    write(found);
  });
  return select;
}

/** @param {Entry} entry @param {(value: any) => void} write */
function inputOf({ value, text, low, high, step = 0.1, usual, whole }, write) {
  const input = make("input", {
    type: text ? "text" : "number",
    value: value === undefined ? "" : String(value),
    placeholder: usual === undefined ? "" : String(usual),
  });
  if (!text) {
    input.step = whole ? "1" : "any";
    if (low !== undefined) input.min = String(low);
    if (high !== undefined) input.max = String(high);
    input.addEventListener("keydown", (event) => stepped(event, input, step));
  }
  input.addEventListener("change", () => {
    if (!text && !input.validity.valid) input.reportValidity();
    else write(input.value === "" ? undefined : text ? input.value : Number(input.value));
  });
  return input;
}

/**
 * Arrows change a number by its step.
 * @param {KeyboardEvent} event
 * @param {HTMLInputElement} input
 * @param {number} step
 */
function stepped(event, input, step) {
  const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
  if (!way) return;
  event.preventDefault();
  const base = Number(input.value || input.placeholder || 0);
  const next = Math.round(1e6 * (base + way * step * (event.shiftKey ? 10 : 1))) / 1e6;
  input.value = String(Math.min(Math.max(next, Number(input.min || -Infinity)), Number(input.max || Infinity)));
  input.dispatchEvent(new Event("change"));
}

/** @param {Editor} editor @param {import("./model.js").Thing} thing @param {(place: number[]) => void} look */
function thingRow(editor, thing, look) {
  const value = valueOf(editor.scene, thing);
  const place = Array.isArray(value) ? value : (value.position ?? value.center ?? value.pose ?? value.vertices?.[0]);
  const act = () => {
    const is = same(editor.chosen, thing);
    editor.choose(is ? null : thing);
    if (!is) look(place);
  };
  const wrong = editor.findings.some(({ scene, key }) => scene === editor.at && same(thingOf(key), thing));
  const row = button(titleOf(editor.scene, thing), act, {
    className: wrong ? "bad" : "",
    "aria-pressed": String(same(editor.chosen, thing)),
  });
  return make("li", {}, row);
}

/** @param {Editor} editor @param {import("./editor.js").Finding} finding @param {(place: number[]) => void} look */
function findingRow(editor, { scene, key, place, line }, look) {
  const thing = thingOf(key);
  const scenes = editor.content?.scenarios ?? [];
  const there = scenes[scene];
  const what = thing && there && valueOf(there, thing) !== undefined ? titleOf(there, thing) : key;
  const where = scenes.length > 1 && there ? `${there.name}: ` : "";
  const act = () => {
    if (scene !== editor.at && there) editor.turnTo(scene);
    if (thing && there && valueOf(there, thing) !== undefined) editor.choose(thing);
    if (place) look(place);
  };
  return make("li", {}, button(`${where}${thing ? `${what}: ` : ""}${line}`, act));
}
