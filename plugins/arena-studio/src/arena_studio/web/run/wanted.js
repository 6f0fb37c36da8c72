// What the form holds, without the DOM: chosen options, changed values, words; kept over a reload.

/**
 * @typedef {object} Wanted
 * @property {Record<string, string[]>} choices options by group; none: what the configuration says by itself
 * @property {Record<string, string>} values texts by key
 * @property {string} more words as one types them
 * @property {string} folder
 */

/** @returns {Wanted} */
export const nothing = () => ({ choices: {}, values: {}, more: "", folder: "" });

/**
 * @param {Wanted} wanted
 * @param {string} group
 * @param {string[]} options those that are empty are left out
 * @returns {Wanted}
 */
export function choose(wanted, group, options) {
  const choices = { ...wanted.choices };
  const chosen = [...new Set(options.filter((option) => option))];
  if (chosen.length) choices[group] = chosen;
  else delete choices[group];
  return { ...wanted, choices };
}

/** @param {Wanted} wanted @param {string} key @param {string} text empty: as the option has it @returns {Wanted} */
export function change(wanted, key, text) {
  const values = { ...wanted.values };
  if (text.trim()) values[key] = text.trim();
  else delete values[key];
  return { ...wanted, values };
}

/**
 * The problems of a scenario file, each once, on its map; all else stays.
 * @param {Wanted} wanted
 * @param {string} path
 * @param {string} map none: the world that was chosen
 * @param {string} scenes how many
 * @returns {Wanted}
 */
export function ofScenario(wanted, path, map, scenes) {
  const found = change(change(choose(wanted, "task", ["scenario"]), "task.path", path), "episodes", scenes);
  return map ? change(choose(found, "world", ["ros_map"]), "world.path", map) : found;
}

/**
 * What a text kept by `kept` holds; nothing where it holds something else.
 * @param {string | null} text
 * @returns {Wanted}
 */
export function restored(text) {
  try {
    const { choices, values, more, folder } = JSON.parse(text ?? "null");
    const listed = Object.entries(choices).every(([, options]) => Array.isArray(options));
    if (listed && typeof values === "object" && typeof more === "string" && typeof folder === "string")
      return { choices, values, more, folder };
  } catch {
    // another version of the studio, or nothing yet
  }
  return nothing();
}

/** Say how long something takes. @param {number} seconds */
export function duration(seconds) {
  if (seconds < 90) return `${Math.round(seconds)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}
