// Mouse, pen and fingers on a view: one works the tool, two fingers, the middle button or space move the view, the
// wheel zooms.

const TWICE = 350; // ms between the clicks of a double click
const NEAR = 6; // pixels

/** @param {import("./view.js").View} view @returns {() => void} lets go */
export function pointers(view) {
  const { canvas } = view;
  /** @type {Map<number, {x: number, y: number}>} */ const down = new Map();
  let panning = false;
  let working = false;
  let last = { time: -TWICE, x: 0, y: 0 };

  /** @param {PointerEvent} event @param {boolean} [double] @returns {import("./tools.js").Hand} */
  const hand = (event, double = false) => ({
    point: view.point(event.offsetX, event.offsetY),
    pixel: [event.offsetX, event.offsetY],
    shift: event.shiftKey,
    alt: event.altKey,
    double,
    touch: event.pointerType === "touch",
  });

  /** @param {PointerEvent} event */
  const pressed = (event) => {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    view.cross = null;
    if (down.size > 1) {
      if (working) view.tool?.cancel?.();
      [panning, working] = [true, false];
      return;
    }
    panning = event.button === 1 || view.spaceHeld || view.tool?.pans === true;
    working = !panning && event.button === 0;
    if (working) view.tool?.down?.(hand(event, isDouble(event)));
    view.request();
  };

  /** @param {PointerEvent} event */
  const isDouble = (event) => {
    const before = last;
    last = { time: event.timeStamp, x: event.offsetX, y: event.offsetY };
    return last.time - before.time < TWICE && Math.hypot(last.x - before.x, last.y - before.y) < NEAR;
  };

  /** @param {PointerEvent} event */
  const moved = (event) => {
    const before = down.get(event.pointerId);
    if (!before) {
      if (view.tool?.hover) {
        view.tool.hover(hand(event));
        view.request();
      }
      return;
    }
    if (panning) drag(event, before);
    else if (working) {
      for (const part of event.getCoalescedEvents?.() ?? [])
        if (part.timeStamp < event.timeStamp) view.tool?.move?.(hand(part));
      view.tool?.move?.(hand(event));
      view.request();
    }
    down.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
  };

  /** @param {PointerEvent} event @param {{x: number, y: number}} before */
  const drag = (event, before) => {
    const other = [...down].find(([id]) => id !== event.pointerId)?.[1];
    if (!other) view.pan(event.offsetX - before.x, event.offsetY - before.y);
    else {
      view.pan((event.offsetX - before.x) / 2, (event.offsetY - before.y) / 2);
      const far = (/** @type {number} */ x, /** @type {number} */ y) =>
        Math.max(Math.hypot(x - other.x, y - other.y), 1);
      view.zoom(
        far(event.offsetX, event.offsetY) / far(before.x, before.y),
        (event.offsetX + other.x) / 2,
        (event.offsetY + other.y) / 2,
      );
    }
  };

  /** @param {PointerEvent} event */
  const released = (event) => {
    if (!down.delete(event.pointerId)) return;
    if (working) {
      if (event.type === "pointerup") view.tool?.up?.(hand(event));
      else view.tool?.cancel?.();
    }
    working = false;
    if (!down.size) panning = false;
    view.request();
  };

  /** @param {WheelEvent} event */
  const wheeled = (event) => {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    view.zoom(Math.exp(-0.0015 * lines * event.deltaY), event.offsetX, event.offsetY);
  };

  const stop = new AbortController();
  const signal = stop.signal;
  canvas.addEventListener("pointerdown", pressed, { signal });
  canvas.addEventListener("pointermove", moved, { signal });
  canvas.addEventListener("pointerup", released, { signal });
  canvas.addEventListener("pointercancel", released, { signal });
  canvas.addEventListener("wheel", wheeled, { passive: false, signal });
  return () => stop.abort();
}
