// What was done and can be taken back: commands, in groups, within a bound of memory.

/** @typedef {{label: string, do: () => void, undo: () => void, bytes?: number}} Command  `bytes` it keeps in memory */

export const MOST_COMMANDS = 1000;
export const MOST_BYTES = 256 * 2 ** 20;

export class History {
  /**
   * @param {() => void} [changed] called after each step, to draw buttons and to save
   * @param {{commands?: number, bytes?: number}} [most] what is kept; beyond that the oldest steps are forgotten
   */
  constructor(changed = () => {}, most = {}) {
    this.changed = changed;
    this.most = { commands: MOST_COMMANDS, bytes: MOST_BYTES, ...most };
    /** @type {Command[]} */ this.done = [];
    /** @type {Command[]} */ this.undone = [];
    /** @type {{label: string, commands: Command[]}[]} */ this.groups = [];
  }

  /** Do a command and keep it. @param {Command} command */
  run(command) {
    command.do();
    this.keep(command);
  }

  /** Keep a command that is done already. @param {Command} command */
  keep(command) {
    const group = this.groups.at(-1);
    if (group) {
      group.commands.push(command);
      return;
    }
    this.undone = [];
    this.done.push(command);
    this.#forget();
    this.changed();
  }

  /** Begin a group: all until its end is one step. Groups may lie in each other. @param {string} label */
  begin(label) {
    this.groups.push({ label, commands: [] });
  }

  /** End the innermost group; an empty one is no step. */
  end() {
    const group = this.groups.pop();
    if (!group || !group.commands.length) return;
    this.keep(
      group.commands.length === 1
        ? { ...group.commands[0], label: group.label }
        : together(group.label, group.commands),
    );
  }

  /** Take back what the innermost group did so far, and drop it. */
  cancel() {
    const group = this.groups.pop();
    for (const command of group?.commands.reverse() ?? []) command.undo();
  }

  /** Take back the last step; return its label, or "" where there is none. */
  undo() {
    const command = this.groups.length ? undefined : this.done.pop();
    if (!command) return "";
    command.undo();
    this.undone.push(command);
    this.changed();
    return command.label;
  }

  /** Do the last step that was taken back once more; return its label, or "" where there is none. */
  redo() {
    const command = this.groups.length ? undefined : this.undone.pop();
    if (!command) return "";
    command.do();
    this.done.push(command);
    this.changed();
    return command.label;
  }

  /** Forget everything, as after another file was opened. */
  clear() {
    this.done = [];
    this.undone = [];
    this.groups = [];
    this.changed();
  }

  get canUndo() {
    return this.done.length > 0;
  }

  get canRedo() {
    return this.undone.length > 0;
  }

  #forget() {
    let bytes = this.done.reduce((sum, command) => sum + (command.bytes ?? 0), 0);
    while (this.done.length > 1 && (this.done.length > this.most.commands || bytes > this.most.bytes)) {
      bytes -= /** @type {Command} */ (this.done.shift()).bytes ?? 0;
    }
  }
}

/** Several commands as one. @param {string} label @param {Command[]} commands @returns {Command} */
export function together(label, commands) {
  return {
    label,
    bytes: commands.reduce((sum, command) => sum + (command.bytes ?? 0), 0),
    do: () => commands.forEach((command) => command.do()),
    undo: () => [...commands].reverse().forEach((command) => command.undo()),
  };
}
