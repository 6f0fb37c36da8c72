"""Where a running episode is, told a few times a second in a small file beside the records, for who watches."""

from __future__ import annotations

import json
import os
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from arena_core.base.errors import InputFileError
from arena_core.base.files import check_inside
from arena_core.values.episode import Scenario, WorldState
from arena_core.values.robot import Robot

EVERY = 0.25  # s between two files


class LiveFile:
    """``live/NNNN.json`` of a run's folder while an episode runs; a file that cannot be written is not missed."""

    def __init__(self, folder: Path, episode: int, scenario: Scenario, robot: Robot, grid: str) -> None:
        self._path = folder / "live" / f"{episode:04d}.json"
        self._said: dict[str, Any] = {
            "episode": episode,
            "scenario": scenario.name,
            "time_limit": scenario.time_limit,
            "goal": [scenario.goal.x, scenario.goal.y],
            "radius": robot.footprint.radius,
            "grid": grid,
            "worker": os.getpid(),
        }
        self._due = 0.0

    def show(self, state: WorldState) -> None:
        """Tell what is now, unless that was told a moment ago."""
        now = monotonic()
        if now < self._due:
            return
        self._due = now + EVERY
        people = state.pedestrians
        there = np.isfinite(people.positions).all(axis=1)
        bodies = np.column_stack((people.positions, people.radii))[there]
        moving = {"stamp": state.stamp, "pose": state.pose.array().tolist(), "people": bodies.round(3).tolist()}
        self._write_file(json.dumps({**self._said, **moving, "contact": bool(state.in_contact)}))

    def remove(self) -> None:
        """Say that the episode is over."""
        with suppress(OSError):
            self._path.unlink()
        with suppress(OSError):
            self._path.parent.rmdir()

    def _write_file(self, text: str) -> None:
        beside = self._path.with_suffix(".part")
        with suppress(OSError, InputFileError):
            self._path.parent.mkdir(exist_ok=True)
            check_inside(self._path.parent.parent, self._path.parent)
            beside.unlink(missing_ok=True)  # whatever is there: a link would be followed
            with beside.open("x", encoding="utf-8") as file:
                file.write(text)
            beside.replace(self._path)
