// Draws what the robot believed and weighed: tracks, and the ways that its planner considered.

import { faded } from "arena/looks.js";

/**
 * How strongly each way is drawn, from 1 for the cheapest to 0 for the dearest; refused ones, and ones of unknown cost,
 * have 0.
 * @param {import("./episode.js").Candidate[]} candidates
 */
export function strengths(candidates) {
  const known = candidates.map(({ cost }) => cost).filter(Number.isFinite);
  const [least, most] = [Math.min(...known), Math.max(...known)];
  return candidates.map(({ cost }) => (Number.isFinite(cost) ? 1 - (cost - least) / Math.max(most - least, 1e-9) : 0));
}

/**
 * The chosen way is thick and the robot's colour, cheap ones are dark, costly ones faint, refused ones dashed.
 * @param {CanvasRenderingContext2D} context
 * @param {import("./episode.js").Candidate[]} candidates
 * @param {string} colour
 * @param {string} bad @param {number} thin m of a pixel
 */
export function drawConsidered(context, candidates, colour, bad, thin) {
  const strong = strengths(candidates);
  candidates.forEach(({ points, cost, chosen }, number) => {
    if (chosen) return;
    const refused = cost === Infinity;
    context.setLineDash(refused ? [3 * thin, 4 * thin] : []);
    line(context, points, faded(refused ? bad : colour, refused ? 0.45 : 0.15 + 0.5 * strong[number]), 1.2 * thin);
  });
  context.setLineDash([]);
  for (const { points, chosen } of candidates) if (chosen) line(context, points, colour, 3.5 * thin);
}

/**
 * A dashed ring where the tracker believes someone to be, with the way of the next second.
 * @param {CanvasRenderingContext2D} context
 * @param {import("./episode.js").Track[]} tracks
 * @param {string} colour
 * @param {number} thin m of a pixel
 */
export function drawTracks(context, tracks, colour, thin) {
  for (const { x, y, vx, vy, radius } of tracks) {
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.setLineDash([4 * thin, 3 * thin]);
    context.strokeStyle = colour;
    context.lineWidth = 1.5 * thin;
    context.stroke();
    context.setLineDash([]);
    if (Math.hypot(vx, vy) > 0.05)
      line(
        context,
        [
          [x, y],
          [x + vx, y + vy],
        ],
        colour,
        1.5 * thin,
      );
  }
}

/** @param {CanvasRenderingContext2D} context @param {number[][]} points @param {string} colour @param {number} width */
function line(context, points, colour, width) {
  context.beginPath();
  for (const [x, y] of points) context.lineTo(x, y);
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.stroke();
}
