// Draws people: a disc each, by what they do with the way of their next second; with legs, where lidars see these, the
// disc is faint.

import { faded, ofState } from "arena/looks.js";

/**
 * @param {CanvasRenderingContext2D} context @param {import("./episode.js").Moment["people"]} people
 * @param {{person: string, ink: string}} colours @param {number} thin m of a pixel @param {number} alpha
 */
export function drawPeople(context, people, colours, thin, alpha) {
  context.lineWidth = 2 * thin;
  for (const person of people) {
    const colour = ofState(person.state, colours);
    disc(context, person.x, person.y, person.radius, faded(colour, person.legs ? 0.35 * alpha : alpha));
    if (person.legs) {
      const [leftX, leftY, rightX, rightY, radius] = person.legs;
      disc(context, leftX, leftY, radius, faded(colour, alpha));
      disc(context, rightX, rightY, radius, faded(colour, alpha));
    }
    const speed = Math.hypot(person.vx, person.vy);
    if (speed < 0.05) continue;
    // the way of the next second, from the disc's edge
    const [from, to] = [person.radius / speed, person.radius / speed + 1];
    context.beginPath();
    context.moveTo(person.x + from * person.vx, person.y + from * person.vy);
    context.lineTo(person.x + to * person.vx, person.y + to * person.vy);
    context.strokeStyle = faded(colour, alpha);
    context.stroke();
  }
}

/** What beams meet of people: their legs, or their discs. @param {import("./episode.js").Moment["people"]} people */
export function bodiesOf(people) {
  return people.flatMap((person) => {
    if (!person.legs) return [person];
    const [leftX, leftY, rightX, rightY, radius] = person.legs;
    return [
      { x: leftX, y: leftY, radius },
      { x: rightX, y: rightY, radius },
    ];
  });
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {number} x
 * @param {number} y
 * @param {number} radius
 * @param {string} colour
 */
function disc(context, x, y, radius, colour) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fillStyle = colour;
  context.fill();
}
