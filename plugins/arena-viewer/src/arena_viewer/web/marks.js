// The marks above the slider: where something was touched, and where that could last be avoided.

import { touched } from "arena/facts.js";

/** @typedef {{stamp: number, type: "contact" | "moment", title: string}} SliderMark */

/**
 * What stands above the slider, in order; of several episodes each title says whose it is.
 * @param {import("./episode.js").Episode[]} episodes
 * @returns {SliderMark[]}
 */
export function marksOf(episodes) {
  const found = episodes.flatMap((episode) => {
    const whose = episodes.length > 1 ? `${episode.name}: ` : "";
    const at = (/** @type {number} */ stamp, /** @type {string} */ text) => `${whose}${stamp.toFixed(1)} s: ${text}`;
    /** @type {SliderMark[]} */
    const contacts = episode.contacts.map((contact) => ({
      stamp: contact.stamp,
      type: "contact",
      title: at(contact.stamp, touched(contact)),
    }));
    /** @type {SliderMark[]} */
    const moments = episode.moments.map(({ stamp, text }) => ({ stamp, type: "moment", title: at(stamp, text) }));
    return [...contacts, ...moments];
  });
  return found.sort((a, b) => a.stamp - b.stamp);
}

/**
 * The time of the next mark after a time, or of the previous one; the time itself where there is none.
 * @param {SliderMark[]} marks @param {number} time @param {1 | -1} way
 */
export function nextMark(marks, time, way) {
  const beyond = marks.filter(({ stamp }) => way * (stamp - time) > 1e-3);
  return beyond.length ? beyond[way > 0 ? 0 : beyond.length - 1].stamp : time;
}

/**
 * Put marks above the slider; a click goes there.
 * @param {HTMLElement} strip @param {SliderMark[]} marks @param {import("./player.js").Player} player
 */
export function showMarks(strip, marks, player) {
  strip.hidden = !marks.length;
  for (const { stamp, type, title } of marks) {
    const button = strip.appendChild(document.createElement("button"));
    button.type = "button";
    button.tabIndex = -1; // keys go from mark to mark, and there may be many
    button.className = type;
    button.title = title;
    button.setAttribute("aria-label", title);
    button.style.left = `${(100 * stamp) / Math.max(player.end, 1e-9)}%`;
    button.addEventListener("click", () => player.seek(stamp));
  }
}
