"""Who of a team is bound for which place, and who has been where."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from arena_core.loop.navigator import Decision
from arena_core.values.errands import Errands
from arena_core.values.geometry import FloatArray, Pose
from arena_core.values.success import ARRIVAL_SLACK


class ErrandBook:
    """Keeps the errands of one episode. A robot that believes itself within ``goal_radius`` m of its place is sent on;
    if it truly is there, as arrivals are judged, the place was visited.
    """

    def __init__(self, errands: Errands, goal_radius: float) -> None:
        self._errands, self._radius = errands, goal_radius
        self._bound_for = list(errands.bound_for)
        self._next = errands.begin()
        self._visits: list[tuple[float, int, int]] = []
        self._missed = 0

    def goal(self, robot: int) -> Pose:
        """Return where a robot is bound for."""
        return Pose(*self._errands.places[self._bound_for[robot]].tolist())

    def look(self, stamp: float, poses: FloatArray, decisions: Sequence[Decision | None]) -> None:
        """Send on who is there, by its own decision (None: it does not drive any more); ``poses`` (M, 3) are true."""
        for robot, decision in enumerate(decisions):
            goal = self.goal(robot)
            if decision is None or decision.estimate.pose.distance(goal) > self._radius:
                continue
            if np.hypot(poses[robot, 0] - goal.x, poses[robot, 1] - goal.y) <= self._radius + ARRIVAL_SLACK:
                self._visits.append((stamp, robot, self._bound_for[robot]))
            else:
                self._missed += 1
            self._bound_for[robot] = self._next(robot, stamp)

    def summary(self) -> dict[str, Any]:
        """Return what records say: ``visits`` are (stamp s, robot, place), ``missed`` counts those that were none."""
        return {
            "kind": self._errands.kind,
            "places": self._errands.places.tolist(),
            "visits": [list(visit) for visit in self._visits],
            "missed": self._missed,
        }
