"""A room of 10 m by 6 m, and problems in it: straight on for 7 m, and two robots that do so side by side."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

SIZE_XY = (10.0, 6.0)
RESOLUTION = 0.05  # m
START, GOAL = (1.5, 3.0, 0.0), (8.5, 3.0)
PAIR_Y = (1.8, 4.2)  # m, of two robots side by side


def write_site(folder: Path) -> Path:
    """Write ``map.yaml``, ``straight.json`` and ``pair.json`` and return the folder."""
    columns, rows = (round(size / RESOLUTION) for size in SIZE_XY)
    cells = np.full((rows, columns), 254, np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = 0
    (folder / "map.pgm").write_bytes(f"P5\n{columns} {rows}\n255\n".encode() + cells.tobytes())
    figures = (
        f"image: map.pgm\nresolution: {RESOLUTION}\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: "
        "0.65\nfree_thresh: 0.196\n"
    )
    (folder / "map.yaml").write_text(figures)
    alone = {"name": "straight", "start": list(START), "goal": list(GOAL)}
    robots = [{"start": [START[0], y, 0.0], "goal": [GOAL[0], y]} for y in PAIR_Y]
    for name, problem in (("straight", alone), ("pair", {"name": "pair", "robots": robots})):
        written = {"format": "arena-scenario", "version": 2, "scenarios": [problem]}
        (folder / f"{name}.json").write_text(json.dumps(written))
    return folder


def world_overrides(site: Path, problem: str = "straight") -> list[str]:
    """Return the words of a command line that put a robot there, or a ``pair``."""
    return [
        "robot=jackal",
        "world=ros_map",
        f"world.path={site}/map.yaml",
        "task=scenario",
        f"task.path={site}/{problem}.json",
    ]
