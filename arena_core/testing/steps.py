"""Samples of what is learned from: transitions, and observations of several robots."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from arena_core.contracts.learning import EarlierScans, ObservationBatch, Situation, Transition
from arena_core.contracts.navigation import PathBatch

ALL = slice(None)
PERIOD = 0.1  # s


def join_batches(batches: Sequence[ObservationBatch]) -> ObservationBatch:
    """Return the observations of several batches of one as one batch."""
    names = ("stamps", "ranges", "poses", "twists", "goals", "waypoints", "last_commands", "recalled")
    arrays: dict[str, Any] = {name: np.concatenate([getattr(batch, name) for batch in batches]) for name in names}
    offsets = np.cumsum([0, *(len(batch.paths.poses) for batch in batches)])
    paths = PathBatch(np.concatenate([batch.paths.poses for batch in batches]), offsets)
    ranges, poses = (
        np.concatenate([getattr(batch.earlier, name) for batch in batches]) for name in ("ranges", "poses")
    )
    maps = tuple(grid for batch in batches for grid in batch.maps)
    tracks = tuple(each for batch in batches for each in batch.tracks)
    foreseen = tuple(ahead for batch in batches for ahead in batch.predictions)
    images = [batch.depths for batch in batches if batch.depths is not None]
    arrays["depths"] = np.concatenate(images) if len(images) == len(batches) else None
    arrays |= {"maps": maps, "tracks": tracks, "predictions": foreseen}
    return ObservationBatch(**arrays, paths=paths, earlier=EarlierScans(ranges, poses))


def transition(robots: int, chosen: slice = ALL, seed: int = 0) -> Transition:
    """Return a step that some robots took near obstacles and people, of those ``chosen``; the first
    arrived, the second collided.
    """
    random = np.random.default_rng(seed)
    before, after = _make_situation(robots, random, chosen), _make_situation(robots, random, chosen)
    commands, last_commands = random.uniform(-1.0, 1.0, (2, robots, 3))[:, chosen]
    arrived, collided, timed_out = (np.arange(robots)[chosen] == k for k in range(3))
    return Transition(before, after, commands, last_commands, arrived, collided, timed_out, PERIOD)


def _make_situation(robots: int, random: np.random.Generator, chosen: slice) -> Situation:
    poses, twists = random.uniform(-1.0, 1.0, (2, robots, 3))[:, chosen]
    lengths = random.uniform(0.0, 1.0, (7, robots))[:, chosen]
    return Situation(poses, twists, *lengths)
