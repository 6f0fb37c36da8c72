// Tools: what the pointer does on a view. One is chosen at a time, by a button or its key.

/**
 * @typedef {[number, number]} Point  m
 * @typedef {{point: Point, pixel: Point, shift: boolean, alt: boolean, double: boolean, touch: boolean}} Hand  where
 * the pointer is, and how
 * @typedef {object} Tool
 * @property {string} name
 * @property {string} title what it does, in a few words
 * @property {string} key one letter
 * @property {string} cursor as in CSS
 * @property {boolean} [pans] a drag moves the view
 * @property {(hand: Hand) => void} [down]
 * @property {(hand: Hand) => void} [move] while pressed
 * @property {(hand: Hand) => void} [hover] while not pressed
 * @property {(hand: Hand) => void} [up]
 * @property {() => void} [cancel] drop what was begun: Escape, a second finger, another tool
 * @property {(event: KeyboardEvent) => boolean} [press] a key that is no tool's; returns whether it was taken
 * @property {(context: CanvasRenderingContext2D, view: import("./view.js").View) => void} [draw] over all layers, in
 * metres
 */

/** @type {Tool} */
export const PAN = { name: "pan", title: "Move the view", key: "h", cursor: "grab", pans: true };

export class Toolbox {
  /**
   * @param {import("./view.js").View} view
   * @param {Tool[]} tools the first one is chosen
   * @param {(tool: Tool) => void} [changed]
   */
  constructor(view, tools, changed = () => {}) {
    this.view = view;
    this.tools = tools;
    /** @type {(tool: Tool) => void} */ this.changed = changed;
    this.current = tools[0];
    view.tool = this.current;
  }

  /** Choose a tool by its name; what another one has begun is dropped. @param {string} name */
  choose(name) {
    const tool = this.tools.find((one) => one.name === name);
    if (!tool) return;
    if (tool !== this.current) this.current.cancel?.();
    this.current = tool;
    this.view.tool = tool;
    this.view.canvas.style.cursor = tool.cursor;
    this.view.request();
    this.changed(tool);
  }

  /**
   * Take a key: the tool's own ones first, then the letters of tools.
   * @param {KeyboardEvent} event
   * @returns {boolean} whether it was taken
   */
  press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    if (this.current.press?.(event)) return true;
    const tool = this.tools.find((one) => one.key === event.key);
    if (tool) this.choose(tool.name);
    return tool !== undefined;
  }

  /** Fill an element with a button for each tool, an accessible radio group. @param {HTMLElement} bar */
  fill(bar) {
    bar.setAttribute("role", "radiogroup");
    bar.replaceChildren(...this.tools.map((tool) => this.#button(tool)));
    const changed = this.changed;
    this.changed = (/** @type {Tool} */ tool) => {
      for (const button of bar.querySelectorAll("button")) mark(button, button.dataset.tool === tool.name);
      changed(tool);
    };
    this.choose(this.current.name);
    bar.addEventListener("keydown", (event) => this.#along(bar, event));
  }

  /** @param {Tool} tool */
  #button(tool) {
    const button = document.createElement("button");
    button.type = "button";
    button.dataset.tool = tool.name;
    button.setAttribute("role", "radio");
    button.title = `${tool.title} (${tool.key})`;
    button.textContent = tool.name;
    button.dataset.key = tool.key;
    button.setAttribute("aria-keyshortcuts", tool.key);
    button.addEventListener("click", () => this.choose(tool.name));
    return button;
  }

  /** Arrows go from tool to tool. @param {HTMLElement} bar @param {KeyboardEvent} event */
  #along(bar, event) {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const at = (this.tools.indexOf(this.current) + step + this.tools.length) % this.tools.length;
    this.choose(this.tools[at].name);
    /** @type {HTMLElement | null} */ (bar.querySelector(`[data-tool="${this.tools[at].name}"]`))?.focus();
  }
}

/** @param {HTMLElement} button @param {boolean} chosen */
function mark(button, chosen) {
  button.setAttribute("aria-checked", String(chosen));
  button.tabIndex = chosen ? 0 : -1;
}

/**
 * Undo and redo by their usual keys; return whether the event was one.
 * @param {KeyboardEvent} event
 * @param {import("./undo.js").History} history
 */
export function undoKeys(event, history) {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return false;
  const key = event.key.toLowerCase();
  if (key !== "z" && key !== "y") return false;
  event.preventDefault();
  if (key === "y" || event.shiftKey) history.redo();
  else history.undo();
  return true;
}

/** Whether keys belong to what is written in. @param {EventTarget | null} target */
export function isWriting(target) {
  return (
    target instanceof HTMLElement &&
    (["INPUT", "SELECT", "TEXTAREA"].includes(target.tagName) || target.isContentEditable)
  );
}
