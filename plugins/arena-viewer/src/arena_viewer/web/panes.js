// Where each episode is drawn: all in one pane, or one pane each.

/**
 * Return the panes of a canvas of so many CSS pixels; episodes of different worlds never share one.
 * @param {import("./episode.js").Episode[]} episodes
 * @param {boolean} beside
 * @param {number} width
 * @param {number} height
 * @returns {import("./scene.js").Pane[]}
 */
export function layOut(episodes, beside, width, height) {
  const one = episodes.every((episode) => episode.map === episodes[0].map);
  if (one && !beside) return [{ x: 0, y: 0, width, height, shown: episodes.map((_, number) => number) }];
  const count = episodes.length;
  const across = Math.max(1, Math.min(count, Math.round(Math.sqrt((count * width) / height))));
  const down = Math.ceil(count / across);
  const gap = 2;
  const [w, h] = [(width - gap * (across - 1)) / across, (height - gap * (down - 1)) / down];
  return episodes.map((_, number) => ({
    x: (number % across) * (w + gap),
    y: Math.floor(number / across) * (h + gap),
    width: w,
    height: h,
    shown: [number],
  }));
}

/** The pane under a pixel. @param {import("./scene.js").Pane[]} panes @param {number} x @param {number} y */
export function paneAt(panes, x, y) {
  return (
    panes.find((pane) => x >= pane.x && x < pane.x + pane.width && y >= pane.y && y < pane.y + pane.height) ?? panes[0]
  );
}
