"""Random problems with so many people as the free ground has room for at a density."""

from __future__ import annotations

from dataclasses import replace

from arena_core import ConfigurationError, Scenario, TaskMode, WorldSource
from arena_core.parameters import NonNegative, NonNegativeInt
from arena_core.scenes import free_area
from arena_tasks.random.random_task import RandomTask


class DensityTask(TaskMode):
    """Problems of ``random`` with ``density`` people per 100 m2 of each map's free ground; its own number of people
    does not count.

    Map, start and goal of a problem are the same at every density. ``rung`` is the number of the density on a ladder
    that chooses rungs by what came of others; such episodes have no pairs.
    """

    def __init__(self, world: WorldSource, density: NonNegative, rung: NonNegativeInt | None, random: TaskMode) -> None:
        if not isinstance(random, RandomTask):
            raise ConfigurationError("task.random.name is not random; allowed: random")
        self._world, self._density, self._problems = world, density, random.problems
        self._stage = -1 if rung is None else rung

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index``; raise ImpossibleScenario when the world has no room for it."""
        area = self._world.world(seed, index).grid.derive(free_area)
        walkers = replace(self._problems.walkers, count=round(self._density * area / 100.0))
        drawn = replace(self._problems, walkers=walkers).scenario(f"density/{index:04d}", seed, index)
        return replace(drawn, stage=self._stage)
