"""The 3-D simulator over walled rooms, among people of the social-force crowd."""

from collections.abc import Callable

import numpy as np
import pytest

from arena_core import Obstacle, PedestrianSpec, Pose, Robot, Scenario, Simulator, World
from arena_core.hosting import compose, load_registry, to_plain
from arena_core.testing import component, room

ROOM = room()
THINGS = (Obstacle(np.array([[1.2, 0.0]]), 0.2), Obstacle(np.array([[-1.5, -0.4], [-1.0, 0.0], [-1.5, 0.4]])))


def build(body: Robot, *overrides: str) -> Simulator:
    """Return a simulator among people who ignore the robot; legs, where an override asks for them, are the crowd's."""
    crowd = component(
        "pedestrians",
        "social_force",
        ["pedestrians.reaction=ignore", *(o for o in overrides if o.startswith("pedestrians"))],
    )
    own = [o for o in overrides if not o.startswith("pedestrians")]
    simulator: Simulator = component("simulator", "mujoco", own, robot=body, pedestrians=crowd)
    return simulator


def draw_scenario(seed: int, people: int = 6, obstacles: bool = True) -> Scenario:
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
    start = Pose(0.0, 0.0, random.uniform(-np.pi, np.pi))
    return Scenario(
        f"crowd/{seed}",
        seed,
        World("room", ROOM),
        start,
        Pose(3.0, 0.0),
        tuple(specs),
        THINGS if obstacles else (),
        0.3,
        60.0,
    )


@pytest.fixture(scope="session")
def simulate() -> Callable[..., Simulator]:
    """Return a function that builds the simulator for a robot."""
    return build


@pytest.fixture(scope="session")
def crowded() -> Callable[..., Scenario]:
    """Return a function that draws a crowded room from a seed."""
    return draw_scenario


@pytest.fixture(scope="session")
def known() -> Callable[[str], Robot]:
    """Return a function that builds a robot of the suite by its name."""
    registry = load_registry()

    def named(name: str) -> Robot:
        return registry.build("robot", to_plain(compose([f"robot={name}"], "component"))["robot"])

    return named
