// A press on a button writes what is being typed first: leaving a field redraws what stands beside it, and the click
// must not be lost by that.

/** What a click acts on. */
const PRESSED = "button, summary, a[href], input[type=checkbox], input[type=radio]";

/**
 * Hold the changes of fields that a press makes be left until the click, which then goes to the button that stands for
 * the pressed one.
 * @param {Document} root
 */
export function holdChanges(root) {
  /** @type {HTMLElement | null} */ let pressed = null;
  let place = 0;
  /** @type {EventTarget[]} */ let held = [];

  function write() {
    const fields = held;
    held = [];
    for (const field of fields) field.dispatchEvent(new Event("change", { bubbles: true }));
  }

  function begin(/** @type {MouseEvent} */ event) {
    write();
    pressed = event.target instanceof Element ? event.target.closest(PRESSED) : null;
    if (pressed) place = alike(root, pressed).indexOf(pressed);
  }

  function hold(/** @type {Event} */ event) {
    if (!pressed || !event.isTrusted || event.target === pressed || !event.target) return;
    event.stopImmediatePropagation();
    held.push(event.target);
  }

  function click(/** @type {MouseEvent} */ event) {
    if (!pressed || !held.length) return;
    const [before, nth] = [pressed, place];
    pressed = null;
    write();
    if (before.isConnected) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    alike(root, before)[nth]?.click();
  }

  function end() {
    pressed = null;
    write();
  }

  /** What is pressed was redrawn meanwhile, by an answer that came just then: the browser knows of no click. */
  function release(/** @type {MouseEvent} */ event) {
    const twin = pressed && !pressed.isConnected ? alike(root, pressed)[place] : null;
    setTimeout(end); // after the click, which comes with it
    if (!twin || !(event.target instanceof Node) || !twin.contains(event.target)) return;
    pressed = null;
    write();
    twin.click();
  }

  root.addEventListener("mousedown", begin, true);
  root.addEventListener("change", hold, true);
  root.addEventListener("click", click, true);
  root.addEventListener("mouseup", release, true);
  root.addEventListener("dragend", end, true);
}

/**
 * All elements that are called what this one is called.
 * @param {Document} root
 * @param {HTMLElement} element
 * @returns {HTMLElement[]}
 */
function alike(root, element) {
  const name = nameOf(element);
  return /** @type {HTMLElement[]} */ ([...root.querySelectorAll(element.tagName)]).filter(
    (one) => nameOf(one) === name,
  );
}

/** @param {Element} element */
function nameOf(element) {
  return element.getAttribute("aria-label") ?? element.textContent;
}
