"""Random problems whose goal is a place in a group of people who stand and talk."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, PedestrianSpec, Pose, Robot, Scenario, TaskMode
from arena_core.parameters import NonNegative, Positive, PositiveInt
from arena_core.scenes import add_furniture, add_obstacles
from arena_tasks.random.free_space import FreeSpace
from arena_tasks.random.random_task import RandomTask

TRIES = 60  # problems drawn for one with room for the group


@dataclass(frozen=True, slots=True)
class GroupParameters:
    """A circle of ``members`` people of ``radius`` m and of the robot, ``spacing`` m apart along it; ``margin`` m are
    free outside.
    """

    members: PositiveInt
    spacing: Positive
    radius: Positive
    margin: NonNegative


class GroupTask(TaskMode):
    """Problems of ``random`` whose goal is the free place on the circle of a ``group`` of people who stand and talk.

    The circle is an F-formation (Kendon 1990). The robot is to face its middle, and not to drive through it.
    """

    def __init__(self, robot: Robot, group: GroupParameters, random: TaskMode) -> None:
        if not isinstance(random, RandomTask):
            raise ConfigurationError("task.random.name is not random; allowed: random")
        self._robot, self._group, self._problems = robot, group, random.problems
        self._circle = group.spacing * (group.members + 1) / (2.0 * np.pi)
        self._room = self._circle + max(group.radius, robot.footprint.radius) + group.margin

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index``; raise ImpossibleScenario when the world has no room for it."""
        return self._problems.scenario_with(f"join_group/{index:04d}", (seed, index), self._with_group, TRIES)

    def _with_group(self, drawn: Scenario) -> Scenario | None:
        """Return the problem with the group round its goal, None where there is no room."""
        space = add_obstacles(add_furniture(drawn.world), drawn.obstacles).derive(FreeSpace)
        middle = drawn.goal.array()[:2]
        row, column = space.grid.cells(middle)
        others = (np.hypot(*(other.position_xy - middle)) - other.radius for other in drawn.pedestrians)
        if min((float(space.clearance[row, column]), *others)) < self._room:
            return None
        back = drawn.start.array()[:2] - middle
        first = float(np.arctan2(back[1], back[0]))
        places = _circle_places(middle, self._circle, first, self._group.members + 1)
        group = tuple(
            PedestrianSpec(
                len(drawn.pedestrians) + number, place, np.empty((0, 2)), 1.0, self._group.radius, {"group": "talk"}
            )
            for number, place in enumerate(places[1:])
        )
        goal = Pose(float(places[0, 0]), float(places[0, 1]), float(np.arctan2(*(middle - places[0])[::-1])))
        return replace(drawn, goal=goal, pedestrians=(*drawn.pedestrians, *group))


def _circle_places(middle: NDArray[np.float64], radius: float, first: float, count: int) -> NDArray[np.float64]:
    """Return places (count, 2) evenly on a circle, the first in the direction ``first``, rad."""
    angles = first + 2.0 * np.pi * np.arange(count) / count
    return np.asarray(middle + radius * np.stack((np.cos(angles), np.sin(angles)), axis=1))
