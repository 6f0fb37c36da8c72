"""The task of the BARN challenge and of DynaBARN: one start, one goal, in every world."""

from __future__ import annotations

import numpy as np

from arena_core import ConfigurationError, ImpossibleScenario, Pose, Robot, Scenario, TaskMode, World, WorldSource
from arena_core.parameters import Positive


class BarnTask(TaskMode):
    """Scenario ``index`` goes from ``start`` to ``goal`` in world ``index``, among its movers;
    ``goal_radius`` m, ``time_limit`` s.
    """

    def __init__(
        self, robot: Robot, world: WorldSource, start: Pose, goal: Pose, goal_radius: Positive, time_limit: Positive
    ) -> None:
        if start.distance(goal) <= goal_radius:
            far = start.distance(goal)
            raise ConfigurationError(
                f"task.goal_radius is {goal_radius:g}; allowed: below the distance from start to goal, {far:g} m"
            )
        self._world = world
        self._start, self._goal = start, goal
        self._goal_radius = goal_radius
        self._time_limit = time_limit

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return the way through world ``index``; its reference length is that of start, the world's reference path and
        goal.

        Raises ImpossibleScenario for a world that does not hold them.
        """
        world = self._world.world(seed, index)
        for name, place in (("start", self._start), ("goal", self._goal)):
            if not world.grid.contains(world.grid.cells([(place.x, place.y)])).all():
                raise ImpossibleScenario(
                    f"task.{name} is ({place.x:g}, {place.y:g}), beyond the map of {world.name}; allowed: "
                    "a place on it, as in world=barn"
                )
        return Scenario(
            name=f"{world.name}/{index:04d}",
            seed=seed,
            world=world,
            start=self._start,
            goal=self._goal,
            pedestrians=world.movers,
            obstacles=(),
            goal_radius=self._goal_radius,
            time_limit=self._time_limit,
            reference_length=self._reference_length(world),
        )

    def _reference_length(self, world: World) -> float | None:
        if world.reference_xy is None:
            return None
        way = np.vstack(((self._start.x, self._start.y), world.reference_xy, (self._goal.x, self._goal.y)))
        return float(np.hypot(*np.diff(way, axis=0).T).sum())
