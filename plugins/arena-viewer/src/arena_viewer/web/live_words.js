// What the page of runs under way says.

/**
 * @typedef {{number: number, name: string, rows: Record<string, string>[], running:
 * import("./live_view.js").Running[]}} Run
 */
/**
 * @typedef {{runs: Run[], total: number, done: number, succeeded: number, left: number | null, workers: number}} State
 */

/** Seconds in words. @param {number} seconds */
export function duration(seconds) {
  if (seconds < 90) return `${Math.round(seconds)} s`;
  return seconds < 5400 ? `${Math.round(seconds / 60)} min` : `${(seconds / 3600).toFixed(1)} h`;
}

/** How far the runs are, in one line. @param {State} state */
export function standing(state) {
  if (!state.runs.length) return "waiting for the run to begin";
  const parts = [`${state.done} of ${state.total} episodes`, `${state.succeeded} succeeded`];
  if (state.done === state.total) return [...parts, "ended"].join(" · ");
  if (state.workers) parts.push(`${state.workers} worker${state.workers > 1 ? "s" : ""} at work`);
  const left = state.left === null ? "time left not known yet" : `about ${duration(state.left)} left`;
  return [...parts, left].join(" · ");
}
