"""Simulators over walled rooms, among people of the social-force crowd."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from arena_core import Obstacle, PedestrianSpec, Pose, Robot, Scenario, Simulator, World
from arena_core.testing import component, room


def build(body: Robot, *overrides: str) -> Simulator:
    """Return a simulator with ticks of 0.01 s, so that a control period has ten, and two crowd steps."""
    crowd = component("pedestrians", "social_force", ["pedestrians.reaction=ignore"])
    timing = ["simulator.inner_step=0.01", "simulator.crowd_period=0.05"]
    simulator: Simulator = component("simulator", "sim2d", [*timing, *overrides], robot=body, pedestrians=crowd)
    return simulator


def draw_scenario(seed: int, people: int = 8, obstacles: bool = True) -> Scenario:
    """Return a crowded room: people criss-cross it, a disc and a triangle stand in
    it; the robot starts at its centre.
    """
    random = np.random.default_rng(seed)
    specs = []
    for i in range(people):
        angle = 2 * np.pi * i / people
        home = random.uniform(2.0, 3.5) * np.array((np.cos(angle), np.sin(angle)))
        specs.append(
            PedestrianSpec(
                i + 1, home, np.array((-home, home)) * random.uniform(0.8, 1.1), random.uniform(0.4, 1.4), 0.3
            )
        )
    things = (Obstacle(np.array([[1.2, 0.0]]), 0.2), Obstacle(np.array([[-1.5, -0.4], [-1.0, 0.0], [-1.5, 0.4]])))
    start = Pose(0.0, 0.0, random.uniform(-np.pi, np.pi))
    return Scenario(
        f"crowd/{seed}",
        seed,
        World("room", ROOM),
        start,
        Pose(3.0, 0.0),
        tuple(specs),
        things if obstacles else (),
        0.3,
        60.0,
    )


ROOM = room()


@pytest.fixture(scope="session")
def simulate() -> Callable[..., Simulator]:
    """Return a function that builds the simulator for a robot."""
    return build


@pytest.fixture(scope="session")
def crowded() -> Callable[..., Scenario]:
    """Return a function that draws a crowded room from a seed."""
    return draw_scenario


@pytest.fixture(scope="session")
def alter() -> Callable[..., Robot]:
    """Return a function that changes parts of a robot's lidar or odometry."""

    def change(body: Robot, part: str, **values: object) -> Robot:
        return replace(body, **{part: replace(getattr(body, part), **values)})

    return change
