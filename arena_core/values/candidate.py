"""What a planner weighed at one control step."""

from __future__ import annotations

from dataclasses import dataclass

from arena_core.values.geometry import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A way that a planner weighed: ``points_xy`` (M, 2) in ``map``, from the robot on.

    ``cost`` orders the candidates of one step, less is better; inf: refused, NaN: not known. ``chosen``: its beginning
    is what was sent.
    """

    points_xy: FloatArray
    cost: float
    chosen: bool = False
