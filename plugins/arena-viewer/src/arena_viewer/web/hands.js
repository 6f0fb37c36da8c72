// What the user's hands do: buttons, keys, mouse, touch.

import { nextMark } from "arena/marks.js";
import { paneAt } from "arena/panes.js";

/**
 * @param {(name: string) => any} element @param {import("./player.js").Player} player @param {any} view
 * @param {import("./plots.js").Plot[]} plots @param {{fit: () => void, resize: () => void,
 * marks: import("./marks.js").SliderMark[], keys: Record<string, () => void>}} act  ``keys``: more of them
 */
export function hands(element, player, view, plots, act) {
  const beside = () => {
    view.beside = element("beside").checked;
    act.resize();
    act.fit();
  };
  const follow = () => {
    view.follow = element("follow").checked;
    if (!view.follow) act.fit();
    player.tell();
  };
  element("play").addEventListener("click", () => player.toggle());
  element("back").addEventListener("click", () => player.stepBy(-1));
  element("forth").addEventListener("click", () => player.stepBy(1));
  element("time").addEventListener("input", () => player.seek(Number(element("time").value)));
  element("speed").addEventListener("change", () => {
    player.speed = Number(element("speed").value);
    player.tell();
  });
  element("follow").addEventListener("change", follow);
  element("beside").addEventListener("change", beside);
  element("whole").addEventListener("click", act.fit);
  layers(view, player);
  for (const plot of plots)
    plot.canvas.addEventListener("pointerdown", (event) => player.seek(plot.timeAt(event.offsetX)));

  const check = (/** @type {string} */ name, /** @type {() => void} */ then) => () => {
    element(name).checked = !element(name).checked;
    then();
  };
  /** @type {Record<string, () => void>} */
  const keys = {
    " ": () => player.toggle(),
    ",": () => player.stepBy(-1),
    ".": () => player.stepBy(1),
    ArrowLeft: () => player.seek(player.time - 1),
    ArrowRight: () => player.seek(player.time + 1),
    n: () => player.seek(nextMark(act.marks, player.time, 1)),
    p: () => player.seek(nextMark(act.marks, player.time, -1)),
    Home: () => player.seek(0),
    End: () => player.seek(player.end),
    "+": () => player.faster(1),
    "-": () => player.faster(-1),
    f: check("follow", follow),
    b: check("beside", beside),
    0: act.fit,
    ...act.keys,
  };
  document.addEventListener("keydown", (event) => {
    const typing = event.target instanceof HTMLElement && ["INPUT", "SELECT", "BUTTON"].includes(event.target.tagName);
    if (event.ctrlKey || event.metaKey || event.altKey || (typing && event.key !== "," && event.key !== ".")) return;
    if (!(event.key in keys)) return;
    event.preventDefault();
    keys[event.key]();
  });
  pointers(element("picture"), view, player);
}

/** A box for each layer. @param {any} view @param {import("./player.js").Player} player */
function layers(view, player) {
  const group = document.querySelector(".layers");
  for (const name of Object.keys(view.layers)) {
    const label = /** @type {Element} */ (group).appendChild(document.createElement("label"));
    const box = label.appendChild(document.createElement("input"));
    box.type = "checkbox";
    box.id = `layer-${name}`;
    box.checked = view.layers[name];
    label.append(` ${name.replaceAll("_", " ")}`);
    box.addEventListener("change", () => {
      view.layers[name] = box.checked;
      player.tell();
    });
  }
}

/**
 * Drag to move, wheel or two fingers to zoom.
 * @param {HTMLCanvasElement} canvas
 * @param {any} view
 * @param {import("./player.js").Player} player
 */
function pointers(canvas, view, player) {
  /** @type {Map<number, PointerEvent>} */ const down = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, event);
  });
  for (const kind of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(kind, (event) => down.delete(/** @type {PointerEvent} */ (event).pointerId));
  }
  canvas.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId);
    if (!before) return;
    const other = [...down.values()].find((one) => one.pointerId !== event.pointerId);
    if (other) {
      const far = (/** @type {PointerEvent} */ one) =>
        Math.hypot(one.offsetX - other.offsetX, one.offsetY - other.offsetY);
      zoom(
        far(event) / Math.max(far(before), 1),
        (event.offsetX + other.offsetX) / 2,
        (event.offsetY + other.offsetY) / 2,
      );
    } else view.camera.pan(event.offsetX - before.offsetX, event.offsetY - before.offsetY);
    down.set(event.pointerId, event);
    player.tell();
  });
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      zoom(Math.exp(-0.0015 * event.deltaY), event.offsetX, event.offsetY);
    },
    { passive: false },
  );
  /** @param {number} factor @param {number} x @param {number} y */
  function zoom(factor, x, y) {
    view.camera.zoom(factor, paneAt(view.panes, x, y), x, y);
    player.tell();
  }
}
