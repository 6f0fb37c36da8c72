// What hands do in the solid world: turn it by dragging, shift it with Shift or the right button, come nearer by wheel
// or two fingers.

/**
 * @param {HTMLCanvasElement} canvas @param {import("./stage.js").Stage} stage
 * @param {{panes: import("../scene.js").Pane[]}} view @param {() => void} changed
 */
export function turnByHand(canvas, stage, view, changed) {
  /** @type {Map<number, PointerEvent>} */ const down = new Map();
  const eyeAt = (/** @type {MouseEvent} */ event) => stage.eyeAt(view.panes, event.offsetX, event.offsetY);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, event);
  });
  for (const kind of ["pointerup", "pointercancel"])
    canvas.addEventListener(kind, (event) => down.delete(/** @type {PointerEvent} */ (event).pointerId));
  canvas.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId);
    if (!before) return;
    const eye = eyeAt(event);
    const other = [...down.values()].find((one) => one.pointerId !== event.pointerId);
    const [dx, dy] = [event.offsetX - before.offsetX, event.offsetY - before.offsetY];
    if (other) {
      const far = (/** @type {PointerEvent} */ one) =>
        Math.hypot(one.offsetX - other.offsetX, one.offsetY - other.offsetY);
      eye.zoom(far(event) / Math.max(far(before), 1));
      eye.shift(dx / 2, dy / 2, canvas.clientHeight);
    } else if (event.shiftKey || event.buttons === 2 || eye.mode === "above") eye.shift(dx, dy, canvas.clientHeight);
    else eye.turn(dx, dy);
    down.set(event.pointerId, event);
    changed();
  });
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      eyeAt(event).zoom(Math.exp(-0.0015 * event.deltaY));
      changed();
    },
    { passive: false },
  );
}
