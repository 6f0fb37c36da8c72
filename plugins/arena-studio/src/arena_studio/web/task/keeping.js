// Keeps rules as an option of the task, `conf/task/NAME.yaml`.

import { button, make } from "studio/shell/forms.js";

/**
 * Ask for a name, and keep the rules under it.
 * @param {import("../shell/pages.js").Context} context
 * @param {"random" | "staged"} task
 * @param {import("./parameters.js").Rules} rules
 */
export async function keepRules(context, task, rules) {
  const name = await nameAsked(
    "Keep these rules as task=NAME (conf/task/NAME.yaml). Name, of small letters, digits and _:",
  );
  if (!name) return;
  const { path } = await context.api.post("/api/curricula/rules", { name, task, rules });
  context.say(`written: ${path}; run it by arena run task=${name}`);
}

/** Ask for a line of text. @param {string} text @returns {Promise<string>} */
function nameAsked(text) {
  const input = make("input", { type: "text", "aria-label": "name", pattern: "[a-z][a-z0-9_]*", required: true });
  const dialog = make(
    "dialog",
    { "aria-label": text },
    make("p", {}, text),
    make("div", { className: "field" }, input),
  );
  const row = make(
    "div",
    { className: "row" },
    button("Keep", () => (input.reportValidity() ? dialog.close(input.value) : undefined), { className: "main" }),
    button("Cancel", () => dialog.close("")),
  );
  dialog.append(row);
  input.addEventListener(
    "keydown",
    (event) => void (event.key === "Enter" && input.reportValidity() && dialog.close(input.value)),
  );
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue);
    });
    document.body.append(dialog);
    dialog.showModal();
    input.focus();
  });
}
