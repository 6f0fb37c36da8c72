// Trigger zones of a person: up to eight discs; once the robot is in one of them, the person starts.

/** @typedef {import("./model.js").Person} Person */
/** @typedef {{number: number, x: number, y: number, radius: number}} Zone  m; numbered from 1 */

export const MOST = 8;

/** @param {number} number */
const prefix = (number) => (number === 1 ? "trigger_zone" : `trigger_zone_${number}`);

/** The zones that count. @param {Person} person @returns {Zone[]} */
export function zonesOf(person) {
  const said = person.behaviour ?? {};
  if (said.start_up_mode !== "trigger_zone") return [];
  const found = [];
  for (let number = 1; number <= MOST; number++) {
    const radius = Number(said[`${prefix(number)}_radius`] ?? 0);
    const [x, y] = ["x", "y"].map((axis, at) => Number(said[`${prefix(number)}_${axis}`] ?? person.position[at]));
    if (radius > 0) found.push({ number, x, y, radius });
  }
  return found;
}

/**
 * The person with a zone changed, or with one more where its number is 0.
 * @param {Person} person
 * @param {Zone} zone
 * @returns {Person}
 */
export function withZone(person, zone) {
  const taken = zonesOf(person).map(({ number }) => number);
  const number = zone.number || Array.from({ length: MOST }, (_, at) => at + 1).find((one) => !taken.includes(one));
  if (!number) return person;
  const name = prefix(number);
  const said = { [`${name}_radius`]: zone.radius, [`${name}_x`]: zone.x, [`${name}_y`]: zone.y };
  return { ...person, behaviour: { ...person.behaviour, start_up_mode: "trigger_zone", ...said } };
}

/**
 * The person without a zone; without any it starts by itself.
 * @param {Person} person
 * @param {number} number
 * @returns {Person}
 */
export function withoutZone(person, number) {
  const behaviour = { ...person.behaviour };
  for (const what of ["radius", "x", "y"]) delete behaviour[`${prefix(number)}_${what}`];
  const left = { ...person, behaviour };
  if (!zonesOf(left).length) delete behaviour.start_up_mode;
  return left;
}
