"""The walk of a recorded person whose place a robot takes."""

from __future__ import annotations

from dataclasses import dataclass

from arena_core.values.geometry import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class RecordedWalk:
    """Where the person was: ``positions_xy`` (K, 2) m in ``map``, at ``stamps`` (K,) s from 0.

    ``person`` is the recording's number of the person, who is left out; ``begin`` is the time of the recording, s, at
    which the walk, and the episode, begins.
    """

    person: int
    begin: float
    stamps: FloatArray
    positions_xy: FloatArray
