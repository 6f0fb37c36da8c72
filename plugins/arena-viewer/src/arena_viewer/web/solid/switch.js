// The choice between the flat picture and the solid world: a box, where to look from, a key each, the page's address.

import { EYES } from "arena/solid/eye.js";
import { turnByHand } from "arena/solid/hands.js";
import { Stage } from "arena/solid/stage.js";

// what the flat picture alone shows
const FLAT = ["follow", "layer-estimate", "layer-tracks", "layer-considered"];
const WORDS = /** @type {Record<string, string>} */ ({
  orbit: "turn around it",
  follow: "follow the robot",
  onboard: "from the robot",
  above: "from above",
});

/**
 * @param {(name: string) => any} element @param {import("../episode.js").Episode[]} episodes
 * @param {{panes: import("../scene.js").Pane[], solid: boolean}} view @param {() => void} changed
 */
export function solidWorld(element, episodes, view, changed) {
  const [flat, canvas, box, eye] = ["picture", "solid", "solid-on", "eye"].map(element);
  const stage = new Stage(canvas, episodes);
  for (const name of EYES) eye.add(new Option(WORDS[name], name));

  async function choose() {
    const wanted = box.checked;
    element("trouble").hidden = true;
    try {
      if (wanted) await stage.open();
    } catch (error) {
      box.checked = false;
      element("trouble").hidden = false;
      element("trouble").textContent = error instanceof Error ? error.message : String(error);
    }
    view.solid = box.checked;
    for (const name of FLAT) element(name)?.toggleAttribute("disabled", view.solid);
    [flat.hidden, canvas.hidden, element("eye-choice").hidden] = [view.solid, !view.solid, !view.solid];
    changed();
  }

  /** @param {string} mode */
  function look(mode) {
    stage.mode = eye.value = mode;
    changed();
  }

  box.addEventListener("change", choose);
  eye.addEventListener("change", () => look(eye.value));
  turnByHand(canvas, stage, view, changed);
  const asked = /^#3d(?:-(\w+))?$/.exec(location.hash);
  if (asked) {
    box.checked = true;
    look(EYES.includes(asked[1]) ? asked[1] : "orbit");
    void choose();
  }
  return {
    stage,
    /** The keys of the solid world. @type {Record<string, () => void>} */
    keys: {
      3: () => {
        box.checked = !box.checked;
        void choose();
      },
      c: () => look(EYES[(EYES.indexOf(stage.mode) + 1) % EYES.length]),
    },
    fit() {
      if (stage.renderer) for (const pane of view.panes) stage.world(pane).eye.reset();
    },
  };
}
