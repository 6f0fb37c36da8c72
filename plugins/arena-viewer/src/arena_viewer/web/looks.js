// Colours: the ground's are the page's, people's are those of pictures in 3-D; robots' differ from both.

export const DOOR = "#a1745f"; // seen on light and dark ground
export const ROBOTS = ["#0072B2", "#8E44AD", "#117A65", "#B7950B", "#C0392B", "#5D6D7E", "#56B4E9"];

/** The colour of a teammate, never that of the robot itself. @param {number} mate */
export function ofMate(mate) {
  return ROBOTS[1 + (mate % (ROBOTS.length - 1))];
}

/**
 * The colours of the ground, from the page's style sheet.
 * @param {Element} element
 */
export function ground(element) {
  const style = getComputedStyle(element);
  const read = (/** @type {string} */ name) => style.getPropertyValue(`--${name}`).trim();
  return {
    free: read("free"),
    wall: read("wall"),
    unknown: read("unknown"),
    ink: read("ink"),
    soft: read("soft"),
    faint: read("faint"),
    person: read("person"),
    beam: read("beam"),
    path: read("path"),
    goal: read("goal"),
    bad: read("bad"),
    paper: read("paper"),
    way: read("way"),
  };
}

/** Colours of people by what they do: walking ones in the suite's colour, the others as in pictures in 3-D. */
const DOING = [
  "",
  "#999999",
  "",
  "#e63326",
  "#f2991a",
  "#8059a6",
  "#8c8c99",
  "#a6a6a6",
  "#009e73",
  "#1a804d",
  "#33b399",
];

/** @param {number} state @param {{person: string}} colours */
export function ofState(state, colours) {
  return DOING[state % DOING.length] || colours.person;
}

/** @param {string} colour #rrggbb @param {number} alpha */
export function faded(colour, alpha) {
  const [r, g, b] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  return `rgba(${r}, ${g}, ${b}, ${alpha})`;
}
