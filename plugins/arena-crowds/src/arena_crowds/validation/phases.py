"""A scenario again and again, its people elsewhere on their rounds each time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from arena_core import OccupancyGrid, PedestrianSpec, Scenario, TaskMode, random_generator
from arena_kernels.shortest_path import ShortestPaths, place_on_patrol

TRIES = 20
APART = 0.1  # m between two people at the start, beyond their bodies


class Phased(TaskMode):
    """The problems of another task; everybody with two waypoints or more starts at a drawn place of the round (stream
    ``phases``).

    Who finds no way round, or no place that is free, starts where the other task says.
    """

    def __init__(self, task: TaskMode) -> None:
        self._task = task

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index`` with its people elsewhere."""
        drawn = self._task.scenario(seed, index)
        random = random_generator(seed, f"{drawn.name}/{index}", "phases")
        people: list[PedestrianSpec] = []
        for spec in drawn.pedestrians:
            people.append(_shift_start(spec, people, drawn.world.grid, random))
        return replace(drawn, name=f"{drawn.name}/phase{index:04d}", pedestrians=tuple(people))


def _shift_start(
    spec: PedestrianSpec, others: list[PedestrianSpec], grid: OccupancyGrid, random: np.random.Generator
) -> PedestrianSpec:
    legs = grid.derive(ShortestPaths).patrol_paths(spec.waypoints_xy, spec.radius) if len(spec.waypoints_xy) > 1 else []
    for share in random.random(TRIES) if legs else ():
        place, leg = place_on_patrol(legs, float(share))
        if all(np.hypot(*(place - other.position_xy)) >= spec.radius + other.radius + APART for other in others):
            return replace(spec, position_xy=place, waypoints_xy=np.roll(spec.waypoints_xy, -leg, axis=0))
    return spec
