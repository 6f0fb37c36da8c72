// A question with some answers, over the page; the browser keeps the focus inside it.

/**
 * Ask, and return the chosen answer; null where the dialog was closed without one.
 * @param {string} text
 * @param {string[]} [choices] the first is the one that Enter takes
 * @returns {Promise<string | null>}
 */
export function ask(text, choices = ["OK", "Cancel"]) {
  const dialog = document.createElement("dialog");
  const words = document.createElement("p");
  words.id = "question";
  words.textContent = text;
  dialog.setAttribute("aria-labelledby", words.id);
  const row = document.createElement("div");
  row.className = "row";
  dialog.append(words, row);
  return new Promise((resolve) => {
    for (const choice of choices) row.append(answer(choice, dialog));
    row.firstElementChild?.classList.add("main");
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue || null);
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}

/** @param {string} choice @param {HTMLDialogElement} dialog */
function answer(choice, dialog) {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = choice;
  button.addEventListener("click", () => dialog.close(choice));
  return button;
}
