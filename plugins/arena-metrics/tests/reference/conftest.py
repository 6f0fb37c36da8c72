"""Small problems that are driven in the real simulator."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import pytest

from arena_core import Pose, Robot, Scenario
from arena_core.hosting import EpisodeLoop, WorldTruth
from arena_core.scenes import Door
from arena_core.testing import component, robot, scenario
from arena_core.testing.samples import person
from arena_reference.ways import Attempt, SearchSettings, WayFinder

ATTEMPTS = (Attempt(0.05, 48, 0.015, 0.02), Attempt(0.025, 96, 0.006, 0.006))
Walk = tuple[tuple[float, float], tuple[float, float], float]  # from, to, m/s


def crossing_people(walks: Sequence[Walk]) -> list:
    """Return people who walk to and fro."""
    return [person(k + 1, *begin, end, begin, speed=speed) for k, (begin, end, speed) in enumerate(walks)]


class Stage:
    """A problem in the walled room, its world begun, and the finder of ways for its robot."""

    def __init__(
        self, kinematics: str, walks: Sequence[Walk], start: Pose | None, reaction: str, doors: Sequence[Door] = ()
    ) -> None:
        self.robot: Robot = robot(kinematics)
        people = component("pedestrians", "social_force", [f"pedestrians.reaction={reaction}"])
        self.simulator = component("simulator", "sim2d", robot=self.robot, pedestrians=people)
        drive = scenario(start=start, people=crossing_people(walks), name=f"stage/{len(walks)}")
        self.scenario: Scenario = replace(drive, doors=tuple(doors))
        self.loop = EpisodeLoop(self.simulator, self.robot.control_period, 1, None)
        self.loop.begin([self.scenario])
        self.truth = WorldTruth(self.loop, 0, self.scenario)
        self.finder = WayFinder(self.robot, SearchSettings(list(ATTEMPTS), 0.3), self.robot.control_period)


@pytest.fixture
def stage() -> Callable[..., Stage]:
    """Give a function that begins a problem: kinematics, people's walks, the start, how people react."""

    def _stage(
        kinematics: str = "differential",
        walks: Sequence[Walk] = (),
        start: Pose | None = None,
        reaction: str = "ignore",
        doors: Sequence[Door] = (),
    ) -> Stage:
        return Stage(kinematics, walks, start, reaction, doors)

    return _stage
