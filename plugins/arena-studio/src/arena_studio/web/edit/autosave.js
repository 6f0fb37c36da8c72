// Saves at most a second after a change; goes on trying while the server is away; tells of a conflict and overwrites
// nothing.

/**
 * @typedef {"saved" | "changed" | "saving" | "away" | "refused" | "conflict"} State
 * @typedef {object} Owner
 * @property {(version: string | null) => Promise<string>} save write what there is now if the file still has this
 * version; return the new one
 * @property {() => Promise<void>} theirs load the file again, and drop what is here
 * @property {() => Promise<void>} copy keep what is here as another file, and go on with that
 * @property {(state: State, said: string) => void} tell show how things stand
 * @property {(text: string, choices: string[]) => Promise<string | null>} ask
 * @typedef {{set: (act: () => void, ms: number) => unknown, clear: (timer: any) => void}} Clock
 */

export const WITHIN = 700; // ms from the first change to the request: with the request itself less than a second
export const AGAIN = [1000, 2000, 4000]; // ms until the next try while the server is away; the last one from then on
const TOKEN = 403; // the server was restarted: it knows this page again once its new address was opened
export const THEIRS = "Load the other version";
export const COPY = "Keep mine as a copy";

/** @type {Clock} */
const CLOCK = { set: (act, ms) => setTimeout(act, ms), clear: (timer) => clearTimeout(timer) };

export class Autosave {
  /**
   * @param {Owner} owner
   * @param {string | null} version of the file as loaded; null: it is not there yet
   * @param {Clock} [clock]
   */
  constructor(owner, version, clock = CLOCK) {
    this.owner = owner;
    this.version = version;
    this.clock = clock;
    /** @type {State} */ this.state = "saved";
    this.unsaved = false;
    this.tries = 0;
    /** @type {unknown} */ this.timer = null;
    /** @type {Promise<void> | null} */ this.running = null;
    this.closed = false;
  }

  /** Say that something changed: it is saved soon. */
  change() {
    this.unsaved = true;
    if (this.state === "conflict" || this.running || this.closed) return;
    if (this.state !== "away") this.#tell("changed", "");
    if (this.timer === null) this.#later(WITHIN);
  }

  /** Save now what is not saved yet. */
  async flush() {
    if (this.running) await this.running;
    if (!this.unsaved || this.state === "conflict" || this.closed) return;
    this.#stop();
    this.running = this.#save();
    await this.running;
    this.running = null;
    if (this.unsaved && this.state === "saved") this.change();
    else if (this.state === "away") this.#later(AGAIN[Math.min(this.tries++, AGAIN.length - 1)]);
  }

  /** Take a version that was loaded again. @param {string | null} version */
  loaded(version) {
    this.#stop();
    this.version = version;
    this.unsaved = false;
    this.#tell("saved", "");
  }

  /** Save what is left and stop; return whether nothing is left. */
  async close() {
    await this.flush();
    this.closed = true;
    this.#stop();
    return !this.unsaved;
  }

  async #save() {
    this.unsaved = false;
    this.#tell("saving", "");
    try {
      this.version = await this.owner.save(this.version);
      this.tries = 0;
      this.#tell("saved", "");
    } catch (error) {
      this.unsaved = true;
      await this.#failed(/** @type {Error & {status?: number}} */ (error));
    }
  }

  /** @param {Error & {status?: number}} error */
  async #failed(error) {
    if (error.status === 409) {
      this.#tell("conflict", error.message);
      await this.settle();
    } else if (error.status && error.status < 500 && error.status !== TOKEN) this.#tell("refused", error.message);
    else this.#tell("away", error.message);
  }

  /** Ask how a conflict is settled; nothing is saved before. */
  async settle() {
    const choice = await this.owner.ask(
      "Another window or program has changed this file. What is in this window is not saved.",
      [THEIRS, COPY],
    );
    if (choice === THEIRS) await this.owner.theirs();
    else if (choice === COPY) await this.owner.copy();
  }

  /** @param {number} ms */
  #later(ms) {
    this.timer = this.clock.set(() => {
      this.timer = null;
      void this.flush();
    }, ms);
  }

  #stop() {
    if (this.timer !== null) this.clock.clear(this.timer);
    this.timer = null;
  }

  /** @param {State} state @param {string} said */
  #tell(state, said) {
    this.state = state;
    this.owner.tell(state, said);
  }
}

/**
 * Save when the page is left, and have the browser ask where that cannot be done in time.
 * @param {() => Autosave | null} autosave
 * @returns {() => void}
 */
export function guardPage(autosave) {
  const hidden = () => {
    if (document.visibilityState === "hidden") void autosave()?.flush();
  };
  /** @param {BeforeUnloadEvent} event */
  const leaving = (event) => {
    const open = autosave();
    if (!open || (!open.unsaved && !open.running)) return;
    void open.flush();
    event.preventDefault();
  };
  document.addEventListener("visibilitychange", hidden);
  addEventListener("beforeunload", leaving);
  return () => {
    document.removeEventListener("visibilitychange", hidden);
    removeEventListener("beforeunload", leaving);
  };
}
