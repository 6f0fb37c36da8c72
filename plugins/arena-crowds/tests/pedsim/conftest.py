"""Walled worlds, people and models built from the presets that are shipped."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from numpy.typing import ArrayLike, NDArray

from arena_core import Crowd, Obstacle, OccupancyGrid, PedestrianSpec, Pose, RobotBatch, Scenario, World
from arena_core.config.configuration import compose, to_plain
from arena_core.hosting import load_registry
from arena_kernels.distance import grid_distance
from arena_pedsim.model import SocialForceModel

settings.register_profile("suite", derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
settings.load_profile("suite")

RACKS = tuple((3.0 + 4.0 * k, low, 4.0 + 4.0 * k, low + 6.0) for k in range(4) for low in (3.0, 11.0))
NOWHERE = (-100.0, -100.0, 0.0)
STEP = 0.05  # s
Box = tuple[float, float, float, float]


class Stage:
    """Makes worlds and lets people walk in them."""

    racks = RACKS

    @staticmethod
    def hall(
        width: float, height: float, walls: Sequence[tuple[float, float, float, float]] = (), resolution: float = 0.05
    ) -> OccupancyGrid:
        """Return a walled hall with its lower left corner at the origin; ``walls``
        are (left, bottom, right, top), m.
        """
        data = np.zeros((round(height / resolution), round(width / resolution)), np.int8)
        data[[0, -1], :] = data[:, [0, -1]] = 100
        for box in walls:
            left, bottom, right, top = (round(edge / resolution) for edge in box)
            data[bottom:top, left:right] = 100
        return OccupancyGrid(data, resolution, Pose(0.0, 0.0))

    @staticmethod
    def person(
        number: int, at: ArrayLike, *waypoints: ArrayLike, speed: float = 1.0, radius: float = 0.3, **behaviour: Any
    ) -> PedestrianSpec:
        """Return a person."""
        return PedestrianSpec(
            number, np.array(at, float), np.array(waypoints, float).reshape(-1, 2), speed, radius, behaviour
        )

    @staticmethod
    def scenario(grid: OccupancyGrid, people: Sequence[PedestrianSpec], obstacles: Sequence[Obstacle] = ()) -> Scenario:
        """Return a scenario; its robot does not matter."""
        return Scenario(
            "stage", 0, World("hall", grid), Pose(0, 0), Pose(1, 0), tuple(people), tuple(obstacles), 0.3, 180.0
        )

    def crowded(self, grid: OccupancyGrid, number: int, seed: int, speed: float | None = None) -> Scenario:
        """Return ``number`` people apart from each other on free ground, each with three waypoints on free ground."""
        random = np.random.default_rng(seed)
        starts = self.free_places(grid, number, random, 0.7)
        specs = []
        for k, start in enumerate(starts):
            own = float(random.uniform(0.3, 1.3)) if speed is None else speed
            specs.append(self.person(k, start, *self.free_places(grid, 3, random, 0.0), speed=own))
        return self.scenario(grid, specs)

    @staticmethod
    def free_places(grid: OccupancyGrid, number: int, random: np.random.Generator, apart: float) -> NDArray[np.float64]:
        """Draw places 0.4 m from walls and this far apart."""
        size = np.array(grid.data.shape)[::-1] * grid.resolution
        room = grid.derive(grid_distance)
        places = np.empty((0, 2))
        while len(places) < number:
            place = random.uniform(0.5, size - 0.5)
            if room[tuple(grid.cells(place))] > 0.4 and (np.hypot(*(place - places).T) > apart).all():
                places = np.vstack((places, place))
        return places

    @staticmethod
    def robots(
        poses: ArrayLike = NOWHERE, velocities: ArrayLike = (0.0, 0.0), radius: float = 0.2, worlds: int = 1
    ) -> RobotBatch:
        """Return robots; one pose counts for all worlds."""
        all_poses, all_velocities = np.empty((worlds, 3)), np.empty((worlds, 2))
        all_poses[:], all_velocities[:] = poses, velocities
        return RobotBatch(all_poses, all_velocities, radius)

    def walk(
        self,
        model: SocialForceModel,
        scenarios: Scenario | Sequence[Scenario],
        seconds: float,
        robots: RobotBatch | None = None,
        dt: float = STEP,
    ) -> Iterator[Crowd]:
        """Begin the scenarios and yield the crowd after every step."""
        scenarios = [scenarios] if isinstance(scenarios, Scenario) else scenarios
        worlds = len(scenarios)
        crowd = model.reset(np.arange(worlds), scenarios, worlds)
        robots = robots or self.robots(worlds=worlds)
        for tick in range(round(seconds / dt)):
            crowd = model.step(crowd, robots, np.full(worlds, tick, np.int64), dt)
            yield crowd


@pytest.fixture
def stage() -> Stage:
    return Stage()


@pytest.fixture
def make_model() -> Callable[..., SocialForceModel]:
    """Return a function that builds a shipped preset; keywords replace keys, mappings replace keys of a group."""

    def make(preset: str = "social_force", **changes: Any) -> SocialForceModel:
        node: dict[str, Any] = to_plain(compose([], f"pedestrians/{preset}").pedestrians)
        for key, value in changes.items():
            node[key] = {**node[key], **value} if isinstance(value, dict) else value
        model: SocialForceModel = load_registry().build("pedestrians", node)
        return model

    return make
