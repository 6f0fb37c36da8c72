"""Draw where the time of a control step goes, as py-spy sampled it: one flame graph below the other, in one scale.

usage: .venv/bin/python benchmarks/draw_samples.py OUT.png NAME=SAMPLES:MILLISECONDS...
  SAMPLES is what `py-spy record -f raw -o SAMPLES --pid PID` wrote of an `arena run` that drives, MILLISECONDS what a
  control step takes
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

EPISODE = "execution.py"  # below its last frame an episode is driven
# they say nothing
PASSED_THROUGH = re.compile(r"<(lambda|listcomp|genexpr)>|^(Once|Entered|Stopwatch)\.|^(Navigator\.decide|_run)$")
KERNEL = "arena_kernels/compiled.py"
COLOURS = {
    "arena_core": "#b8b8b8",
    "arena_sim2d": "#8fb8de",
    "arena_pedsim": "#a9d18e",
    "arena_navigation": "#f4c27a",
    "arena_kernels": "#e8927c",
    "planner and others": "#c39bd3",
}
LEAST = 0.004  # share of the widest graph below which a block is left out
NAMED = 0.045  # share from which on its name has room


@dataclass
class Block:
    """A function, and those that it called: ``samples`` were taken within it."""

    name: str
    package: str
    samples: int = 0
    parts: dict[str, Block] = field(default_factory=dict)

    def within(self, name: str, package: str) -> Block:
        """Return the part of this name."""
        return self.parts.setdefault(name, Block(name, package))


def read_samples(path: Path) -> Block:
    """Return the blocks of a file of samples, from the loop of an episode on."""
    root = Block("control step", "arena_core")
    for line in path.read_text(encoding="utf-8").splitlines():
        stack, _, count = line.rpartition(" ")
        frames = stack.split(";")
        places = [k for k, frame in enumerate(frames) if EPISODE in frame]
        if not places:
            continue
        block = root
        block.samples += int(count)
        for name, package in shown_frames(frames[places[-1] + 1 :]):
            block = block.within(name, package)
            block.samples += int(count)
    return root


def shown_frames(frames: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Return name and package of the frames that say something."""
    for frame in frames:
        name, _, place = frame.partition(" (")
        package = place.split("/")[0]
        if KERNEL in place:
            yield "kernel", "arena_kernels"
        elif not PASSED_THROUGH.search(name):
            yield (
                name,
                package if package in COLOURS else "planner and others" if package.startswith("arena_") else "library",
            )


def draw_graphs(graphs: list[tuple[str, Block, float]], target: Path) -> None:
    """Draw the graphs, each as wide as its control step takes."""
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch
    from PIL import Image

    widest = max(ms for *_, ms in graphs)
    figure = Figure(figsize=(13.0, 3.3 * len(graphs) + 0.5), layout="constrained")
    for axes, (name, root, ms) in zip(
        figure.subplots(len(graphs), 1, sharex=True, squeeze=False)[:, 0], graphs, strict=True
    ):
        _draw_block(axes, root, 0.0, 0, ms / max(root.samples, 1), widest)
        axes.set(xlim=(0.0, widest), title=f"{name}: {ms:.2f} ms, {root.samples} samples", yticks=[])
        axes.spines[["top", "left", "right"]].set_visible(False)
    axes.set_xlabel("ms a control step")
    named = [*COLOURS.items(), ("library", "#dddddd")]
    figure.legend(
        handles=[Patch(color=colour, label=label) for label, colour in named],
        ncols=7,
        loc="outside lower center",
        frameon=False,
    )
    figure.savefig(target, dpi=90)
    with Image.open(target) as picture:
        small = picture.convert("RGB").quantize(64, dither=Image.Dither.NONE)
    small.save(target, optimize=True)


def _draw_block(axes: Any, block: Block, left: float, depth: int, scale: float, widest: float) -> None:
    width = scale * block.samples
    if width < LEAST * widest:
        return
    axes.barh(
        depth,
        width,
        left=left,
        height=0.94,
        color=COLOURS.get(block.package, "#dddddd"),
        edgecolor="white",
        linewidth=0.6,
    )
    if width > NAMED * widest:
        room = int(150 * width / widest)
        fits = [name for name in (block.name, block.name.partition(".")[0]) if len(name) <= room]
        text = fits[0] if fits else f"{block.name[: room - 1]}…"
        axes.text(left + 0.003 * widest, depth, text, va="center", fontsize=7.5, clip_on=True)
    for part in sorted(block.parts.values(), key=lambda part: part.name):
        _draw_block(axes, part, left, depth + 1, scale, widest)
        left += scale * part.samples


def main(words: list[str]) -> None:
    """Read the words and draw."""
    target, *told = words
    graphs = []
    for word in told:
        found = re.fullmatch(r"([^=]+)=(.+):(\d+\.?\d*)", word)
        if not found or not Path(found[2]).is_file():
            print(f"draw_samples: {word}; allowed: NAME=SAMPLES:MILLISECONDS, SAMPLES a file", file=sys.stderr)
            sys.exit(2)
        graphs.append((found[1], read_samples(Path(found[2])), float(found[3])))
    draw_graphs(graphs, Path(target))
    print(target)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        print(__doc__)
        sys.exit(2)
    main(sys.argv[1:])
