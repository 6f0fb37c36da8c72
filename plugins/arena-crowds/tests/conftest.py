"""Walled worlds, people and models built from the presets that are shipped."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from numpy.typing import ArrayLike

from arena_core import Crowd, OccupancyGrid, PedestrianModel, PedestrianSpec, Pose, RobotBatch, Scenario, World
from arena_core.testing import component

settings.register_profile("suite", derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
settings.load_profile("suite")

RACKS = tuple((3.0 + 4.0 * k, low, 4.0 + 4.0 * k, low + 6.0) for k in range(4) for low in (3.0, 11.0))
NOWHERE = (-100.0, -100.0, 0.0)
STEP = 0.05  # s
STREET = Path(__file__).parents[3] / "tests" / "data" / "pedestrians" / "street" / "obsmat.txt"
ZARA = Path(__file__).parents[4] / "shared" / "data" / "pedestrians" / "ucy" / "zara01" / "obsmat.txt.gz"


class Stage:
    """Makes worlds and lets people walk in them."""

    racks = RACKS

    @staticmethod
    def hall(width: float, height: float, walls: Sequence[tuple[float, float, float, float]] = ()) -> OccupancyGrid:
        """Return a walled hall with its lower left corner at the origin; ``walls``
        are (left, bottom, right, top), m.
        """
        data = np.zeros((round(height / 0.05), round(width / 0.05)), np.int8)
        data[[0, -1], :] = data[:, [0, -1]] = 100
        for box in walls:
            left, bottom, right, top = (round(edge / 0.05) for edge in box)
            data[bottom:top, left:right] = 100
        return OccupancyGrid(data, 0.05, Pose(0.0, 0.0))

    @staticmethod
    def person(
        number: int, at: ArrayLike, *waypoints: ArrayLike, speed: float = 1.0, radius: float = 0.3
    ) -> PedestrianSpec:
        """Return a person."""
        return PedestrianSpec(number, np.array(at, float), np.array(waypoints, float).reshape(-1, 2), speed, radius)

    @staticmethod
    def scenario(
        grid: OccupancyGrid, people: Sequence[PedestrianSpec] = (), name: str = "stage", limit: float = 180.0
    ) -> Scenario:
        """Return a scenario whose robot starts at (1, 1)."""
        return Scenario(name, 0, World("hall", grid), Pose(1, 1), Pose(2, 1), tuple(people), (), 0.3, limit)

    def crowded(self, grid: OccupancyGrid, number: int, seed: int, name: str = "stage") -> Scenario:
        """Return ``number`` people at random places of a hall, 0.7 m apart and 0.4 m from walls,
        each with three such waypoints.
        """
        random = np.random.default_rng(seed)
        size = np.array(grid.data.shape)[::-1] * grid.resolution
        places: list[Any] = []
        while len(places) < 4 * number:
            place = random.uniform(0.5, size - 0.5)
            around = grid.cells(place + 0.4 * np.stack((np.cos(ANGLES), np.sin(ANGLES)), axis=1))
            starts = np.reshape(places[: min(number, len(places))], (-1, 2))
            if not grid.occupied[tuple(around.T)].any() and (
                len(places) >= number or (np.hypot(*(starts - place).T) > 0.7).all()
            ):
                places.append(place)
        starts, goals = places[:number], places[number:]
        specs = [
            self.person(k, at, *goals[3 * k : 3 * k + 3], speed=float(random.uniform(0.3, 1.4)))
            for k, at in enumerate(starts)
        ]
        return self.scenario(grid, specs, name)

    @staticmethod
    def robots(poses: ArrayLike = NOWHERE, velocities: ArrayLike = (0.0, 0.0), worlds: int = 1) -> RobotBatch:
        """Return robots of 0.2 m radius; one pose counts for all worlds."""
        all_poses, all_velocities = np.empty((worlds, 3)), np.empty((worlds, 2))
        all_poses[:], all_velocities[:] = poses, velocities
        return RobotBatch(all_poses, all_velocities, 0.2)

    def walk(
        self,
        model: PedestrianModel,
        scenarios: Sequence[Scenario],
        seconds: float,
        robots: RobotBatch | None = None,
        dt: float = STEP,
    ) -> Iterator[Crowd]:
        """Begin the scenarios and yield the crowd after every step."""
        worlds = len(scenarios)
        crowd = model.reset(np.arange(worlds), scenarios, worlds)
        robots = robots or self.robots(worlds=worlds)
        for tick in range(round(seconds / dt)):
            crowd = model.step(crowd, robots, np.full(worlds, tick, np.int64), dt)
            yield crowd


ANGLES = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)


@pytest.fixture
def stage() -> Stage:
    return Stage()


@pytest.fixture
def orca() -> PedestrianModel:
    return component("pedestrians", "orca")  # type: ignore[no-any-return]


@pytest.fixture(scope="session", params=["drawn", "zara01"])
def street(request: pytest.FixtureRequest) -> Path:
    """Return a recording of people in a street, as UCY's obsmat: a drawn one, and zara01 where it is there."""
    return STREET if request.param == "drawn" else request.getfixturevalue("zara")  # type: ignore[no-any-return]


@pytest.fixture(scope="session")
def zara() -> Path:
    """Return a recording of people in a street, where it is there."""
    if not ZARA.exists():
        pytest.skip(f"the recording zara01 of UCY is not at {os.path.relpath(ZARA)}")
    return ZARA
