// Puts the viewer together: the document, what shows it, and what the user's hands do.

import { Camera, windowOf } from "arena/camera.js";
import { bytesOf, decode, unpack } from "arena/decode.js";
import { Episode } from "arena/episode.js";
import { Facts } from "arena/facts.js";
import { hands } from "arena/hands.js";
import { marksOf, showMarks } from "arena/marks.js";
import { layOut } from "arena/panes.js";
import { Player, SPEEDS } from "arena/player.js";
import { CURVES, Plot } from "arena/plots.js";
import { Scene } from "arena/scene.js";
import { solidWorld } from "arena/solid/switch.js";

const LAYERS = {
  path: true,
  trail: true,
  lidar: true,
  people: true,
  estimate: false,
  tracks: true,
  considered: true,
  way_out: true,
};
const KEPT = /** @type {[keyof typeof LAYERS, string][]} */ ([
  ["tracks", "track_rows"],
  ["considered", "considered_rows"],
]); // only where records hold them
const FRAMES = 240; // of which the script's time is kept

/** @param {string} name @returns {any} */
const element = (name) => document.getElementById(name);

/** @returns {Promise<ArrayBuffer>} */
async function fetched() {
  const inside = element("document").textContent.trim();
  if (inside) return unpack(bytesOf(inside));
  const answer = await fetch(`document${location.search}`);
  if (!answer.ok) throw new Error(`${answer.status}: ${await answer.text()}`);
  return unpack(new Uint8Array(await answer.arrayBuffer()));
}

/** @param {Episode[]} episodes */
function show(episodes) {
  const canvas = element("picture");
  const player = new Player(Math.max(...episodes.map((episode) => episode.end)), episodes[0].said.robot.period);
  const view = {
    camera: new Camera(),
    panes: layOut(episodes, false, 1, 1),
    follow: false,
    beside: episodes.length > 1,
    solid: false,
    layers: { ...LAYERS },
  };
  if (episodes.length > 1) view.layers.lidar = false;
  for (const [layer, array] of KEPT)
    if (!episodes.some((episode) => array in episode.arrays)) delete (/** @type {any} */ (view.layers)[layer]);
  if (!episodes.some((episode) => episode.moments.length)) delete (/** @type {any} */ (view.layers).ways);
  const marks = marksOf(episodes);
  const scene = new Scene(canvas, episodes);
  const facts = new Facts(element("facts"), episodes);
  const plots = CURVES.map(
    (curve) => new Plot(element("plots").appendChild(document.createElement("canvas")), curve, episodes),
  );
  const spent = /** @type {number[]} */ ([]); // ms of script a frame
  let due = true;
  player.listen(() => (due = true));
  const solid = solidWorld(element, episodes, view, () => (due = true));

  function fit() {
    const pane = view.panes[0];
    const windows = episodes.map(windowOf);
    const ends = [Math.min, Math.max, Math.min, Math.max].map((choose, side) =>
      choose(...windows.map((window) => window[side])),
    );
    view.camera.fit(ends, pane.width, pane.height);
    solid.fit();
    due = true;
  }

  function resize() {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [element("stage").clientWidth, element("stage").clientHeight];
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    view.panes = layOut(episodes, view.beside, width, height);
    for (const plot of plots) plot.layOut(ratio);
    due = true;
  }

  function draw() {
    const began = performance.now();
    const { time } = player;
    if (view.follow) [view.camera.x, view.camera.y] = episodes[0].at(Math.min(time, episodes[0].end)).pose;
    const ratio = window.devicePixelRatio || 1;
    if (view.solid) solid.stage.draw(view.panes, time, view.layers, ratio);
    else scene.draw(view.panes, view.camera, time, view.layers, ratio);
    for (const plot of plots) plot.draw(time);
    facts.tell(time);
    element("time").value = time;
    element("clock").textContent = `${time.toFixed(1)} of ${player.end.toFixed(1)} s`;
    element("play").textContent = player.playing ? "❚❚" : "▶";
    element("play").setAttribute("aria-label", player.playing ? "stop" : "play");
    element("speed").value = String(player.speed);
    spent.push(performance.now() - began);
    if (spent.length > FRAMES) spent.shift();
  }

  let before = 0;
  /** @param {number} now ms */
  function frame(now) {
    player.advance(Math.min(0.25, (now - before) / 1000));
    before = now;
    if (due) {
      due = false;
      draw();
    }
    requestAnimationFrame(frame);
  }

  element("time").max = player.end;
  for (const speed of SPEEDS) element("speed").add(new Option(`${speed} ×`, String(speed)));
  element("beside-choice").hidden = episodes.length < 2;
  element("beside").checked = view.beside;
  showMarks(element("marks"), marks, player);
  hands(element, player, view, plots, { fit, resize, marks, keys: solid.keys });
  new ResizeObserver(() => {
    resize();
    if (!view.follow && player.time === 0) fit();
  }).observe(element("stage"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    scene.recolour();
    solid.stage.recolour();
    resize();
  });
  resize();
  fit();
  Object.assign(window, { arena: { player, view, episodes, spent, stage: solid.stage } }); // for tests and the curious
  requestAnimationFrame(frame);
}

try {
  const { maps, episodes } = decode(await fetched());
  show(episodes.map((said) => new Episode(said, maps)));
} catch (error) {
  element("trouble").hidden = false;
  element("trouble").textContent = `This cannot be shown: ${error instanceof Error ? error.message : error}`;
}
