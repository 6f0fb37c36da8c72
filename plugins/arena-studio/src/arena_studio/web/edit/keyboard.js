// Keys on a view that has the focus. Arrows move a crosshair that works the tool as a pointer does: Enter presses and
// lets go.

const STRIDE = 8; // pixels that an arrow moves the crosshair where the view has no step
const PAN = 60; // pixels

/** @type {Record<string, [number, number]>} */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** @param {import("./view.js").View} view @returns {() => void} lets go */
export function keyboard(view) {
  const { canvas } = view;
  let held = false;

  /** @param {KeyboardEvent} event @param {boolean} [double] @returns {import("./tools.js").Hand} */
  const hand = (event, double = false) => {
    const point = view.cross ?? [view.camera.x, view.camera.y];
    return { point, pixel: view.over(point), shift: event.shiftKey, alt: event.altKey, double, touch: false };
  };

  /** @param {KeyboardEvent} event @param {[number, number]} way */
  const arrow = (event, [dx, dy]) => {
    if (event.altKey) return view.pan(-PAN * dx, PAN * dy);
    const stride = (view.step || STRIDE * view.pixel) * (event.shiftKey ? 10 : 1);
    const [x, y] = view.cross ?? [view.camera.x, view.camera.y];
    view.cross = view.cross ? [x + dx * stride, y + dy * stride] : [x, y];
    keepInSight(view);
    if (held) view.tool?.move?.(hand(event));
    else view.tool?.hover?.(hand(event));
  };

  /** @param {KeyboardEvent} event */
  const enter = (event) => {
    view.cross ??= [view.camera.x, view.camera.y];
    if (held) view.tool?.up?.(hand(event));
    else view.tool?.down?.(hand(event, event.shiftKey));
    held = !held && view.tool?.pans !== true;
  };

  const escape = () => {
    view.tool?.cancel?.();
    view.cross = null;
    held = false;
  };

  /** @type {Record<string, (event: KeyboardEvent) => void>} */
  const keys = {
    Enter: enter,
    Escape: escape,
    "+": () => view.zoom(1.25),
    "=": () => view.zoom(1.25),
    "-": () => view.zoom(0.8),
    0: () => view.fit(),
    " ": () => {
      view.spaceHeld = true;
    },
  };

  /** @param {KeyboardEvent} event */
  const pressed = (event) => {
    if (event.ctrlKey || event.metaKey) return;
    if (event.key in ARROWS) arrow(event, ARROWS[event.key]);
    else if (event.key in keys && !event.altKey) keys[event.key](event);
    else return;
    event.preventDefault();
    view.request();
  };

  /** @param {KeyboardEvent} event */
  const released = (event) => {
    if (event.key === " ") view.spaceHeld = false;
  };

  const stop = new AbortController();
  canvas.addEventListener("keydown", pressed, { signal: stop.signal });
  addEventListener("keyup", released, { signal: stop.signal });
  canvas.addEventListener("blur", () => (view.spaceHeld = false), { signal: stop.signal });
  return () => stop.abort();
}

/** Move the view after a crosshair that leaves it. @param {import("./view.js").View} view */
function keepInSight(view) {
  const [x, y] = view.over(/** @type {[number, number]} */ (view.cross));
  const margin = 24;
  const beyond = (/** @type {number} */ at, /** @type {number} */ most) =>
    Math.min(at - margin, 0) + Math.max(at - most + margin, 0);
  view.pan(-beyond(x, view.pane.width), -beyond(y, view.pane.height));
}
