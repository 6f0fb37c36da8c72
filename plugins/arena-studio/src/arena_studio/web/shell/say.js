// Lines at the foot of the window, which screen readers speak: what was done, and what went wrong.

const STAYS = 6000; // ms of what was done; what went wrong stays until the next line or a click

let timer = 0;

/** @param {string} text @param {"done" | "error"} [kind] */
export function say(text, kind = "done") {
  const [place, other] = kind === "error" ? ["wrong", "said"] : ["said", "wrong"];
  const region = /** @type {HTMLElement} */ (document.getElementById(place));
  /** @type {HTMLElement} */ (document.getElementById(other)).replaceChildren();
  window.clearTimeout(timer);
  if (!text) return region.replaceChildren();
  const line = document.createElement("p");
  line.textContent = text;
  region.replaceChildren(line, ...(kind === "error" ? [closer(region)] : []));
  if (kind !== "error") timer = window.setTimeout(() => region.replaceChildren(), STAYS);
}

/** @param {HTMLElement} region */
function closer(region) {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = "✕";
  button.setAttribute("aria-label", "close the message");
  button.addEventListener("click", () => region.replaceChildren());
  return button;
}
