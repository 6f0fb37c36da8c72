// The time that is shown: it runs while playing, and everything that shows it is told.

export const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16];

export class Player {
  /** @param {number} end s @param {number} step s of a control step */
  constructor(end, step) {
    this.end = end;
    this.step = step;
    this.time = 0;
    this.speed = 1;
    this.playing = false;
    /** @type {(() => void)[]} */ this.listeners = [];
  }

  /** @param {() => void} listener */
  listen(listener) {
    this.listeners.push(listener);
  }

  tell() {
    for (const listener of this.listeners) listener();
  }

  /** @param {number} time */
  seek(time) {
    this.time = Math.min(this.end, Math.max(0, time));
    this.tell();
  }

  /** One control step forwards or back. @param {number} count */
  stepBy(count) {
    this.playing = false;
    this.seek((Math.round(this.time / this.step) + count) * this.step);
  }

  /** One speed quicker or slower. @param {number} count */
  faster(count) {
    const at = SPEEDS.indexOf(this.speed) + count;
    this.speed = SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, at))];
    this.tell();
  }

  toggle() {
    if (!this.playing && this.time >= this.end) this.time = 0;
    this.playing = !this.playing;
    this.tell();
  }

  /** Let time go on. @param {number} seconds of the viewer's clock */
  advance(seconds) {
    if (!this.playing) return;
    this.time = Math.min(this.end, this.time + this.speed * seconds);
    if (this.time >= this.end) this.playing = false;
    this.tell();
  }
}
