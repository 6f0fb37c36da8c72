// What is said beside the picture: who drove, how it ended, and what holds now.

import { ROBOTS } from "arena/looks.js";

const DRIVER = "driver"; // the event by which a switch says which of its members drives
const ENDED = /** @type {Record<string, string>} */ ({
  goal_reached: "goal reached",
  time_out: "time-out",
  false_arrival: "false arrival",
  collision: "stopped at a collision",
  error: "error",
});

/** @param {string} kind @param {string} text @param {string} [type] */
function make(kind, text, type = "") {
  const element = document.createElement(kind);
  element.textContent = text;
  if (type) element.className = type;
  return element;
}

/** How an episode ended, in words. @param {import("./episode.js").Episode} episode */
export function verdict(episode) {
  const { metrics, outcome, error } = episode.said;
  if (outcome === "error") return `error: ${error}`;
  const collisions = episode.collisions.length;
  const said = ENDED[outcome] ?? outcome;
  const many = collisions ? `, ${collisions} collision${collisions > 1 ? "s" : ""}` : ", no collision";
  return `${metrics.success === 1 ? "success: " : ""}${said}${many}`;
}

/** What a contact was, in words. @param {{kind: string, speed: number, caused: boolean}} contact */
export function touched({ kind, speed, caused }) {
  const what = caused
    ? `hits ${kind === "obstacle" ? "an" : "a"} ${kind}`
    : `is hit by ${kind === "obstacle" ? "an" : "a"} ${kind}`;
  return Number.isFinite(speed) ? `${what} at ${speed.toFixed(2)} m/s` : what;
}

export class Facts {
  /** @param {HTMLElement} list @param {import("./episode.js").Episode[]} episodes */
  constructor(list, episodes) {
    this.episodes = episodes;
    /** @type {HTMLElement[]} */ this.now = [];
    episodes.forEach((episode, number) => {
      const { columns } = episode.said;
      const item = list.appendChild(document.createElement("li"));
      const swatch = item.appendChild(make("span", "", "swatch"));
      swatch.style.background = ROBOTS[number % ROBOTS.length];
      const text = item.appendChild(document.createElement("div"));
      text.append(make("b", `${episode.name} on ${columns.robot}`));
      text.append(
        make(
          "span",
          ` ${columns.world}, ${columns.scenario || `episode ${columns.episode}`}, seed ${columns.seed}`,
          "soft",
        ),
      );
      text.append(make("div", verdict(episode), episode.said.metrics.success === 1 ? "" : "bad"));
      this.now.push(/** @type {HTMLElement} */ (text.appendChild(make("div", "", "soft now"))));
    });
  }

  /** Say what holds at a time. @param {number} time */
  tell(time) {
    this.episodes.forEach((episode, number) => {
      const row = episode.rowAt(Math.min(time, episode.end));
      const speed = Math.hypot(episode.value("twist", row, 0), episode.value("twist", row, 1));
      const clearance = episode.value("clearance", row);
      const before = episode.said.events.filter((/** @type {any} */ e) => e.stamp <= time);
      const event = before.filter((/** @type {any} */ e) => e.kind !== DRIVER && time - e.stamp < 1.5).pop();
      const driver = before.filter((/** @type {any} */ e) => e.kind === DRIVER).pop();
      const parts = [
        ...(driver ? [`${driver.detail} drives`] : []),
        `${speed.toFixed(2)} m/s`,
        Number.isFinite(clearance) ? `${clearance.toFixed(2)} m clear` : "nothing near",
      ];
      const contact = episode.contacts.filter((one) => one.stamp <= time && time - one.stamp < 1.5).pop();
      const mark = episode.marks.filter((one) => one.stamp <= time && time - one.stamp < 1.5).pop();
      if (time > episode.end) parts.push("ended");
      else if (contact) parts.push(touched(contact));
      else if (mark) parts.push(mark.text);
      else if (event) parts.push(`${event.kind.replaceAll("_", " ")}${event.detail ? ` (${event.detail})` : ""}`);
      const text = parts.join(" · ");
      if (this.now[number].textContent !== text) this.now[number].textContent = text;
    });
  }
}
