"""Random problems with a person whom the robot follows, accompanies or leads."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ConfigurationError,
    PedestrianSpec,
    Pose,
    Robot,
    Scenario,
    TaskMode,
)
from arena_core.parameters import Fraction, Positive
from arena_core.scenes import add_furniture, add_obstacles
from arena_core.tasks import Company
from arena_tasks.random.random_task import RandomTask
from arena_tasks.random.route import find_route

Manner = Literal["follow", "accompany", "lead"]
TRIES = 20  # problems drawn for one where the person has room
GAP = 0.3  # m, least free between the person and others at the start
# asks the robot to lead, at once and for as long as it takes (docs/pedestrians.md, states 19 and 20)
FOLLOWER = MappingProxyType({"requesting_guide_probability": 1.0, "requesting_guide_base_time": 1e6})


@dataclass(frozen=True, slots=True)
class CompanionParameters:
    """The person: ``radius`` m, walks at a share of the robot's greatest speed, ``speed_most`` m/s at most."""

    radius: Positive
    speed_share: Fraction
    speed_most: Positive


@dataclass(frozen=True, slots=True)
class CompanyParameters:
    """What the robot does with the person, and within which distances of their centres the two are together, m."""

    manner: Manner
    nearest: Positive
    farthest: Positive


class CompanyTask(TaskMode):
    """Problems of ``random`` with one person more, whose way is the robot's.

    Who goes ahead starts half-way between the least and the greatest distance of ``company`` along the way. The person
    walks to the goal; one who is led follows the robot, where the pedestrian model knows how.
    """

    def __init__(self, robot: Robot, company: CompanyParameters, person: CompanionParameters, random: TaskMode) -> None:
        if not isinstance(random, RandomTask):
            raise ConfigurationError("task.random.name is not random; allowed: random")
        try:
            self._company = Company(company.manner, 0, company.nearest, company.farthest)
        except ConfigurationError as error:
            raise ConfigurationError(f"task.company.{error}") from None
        self._robot, self._person, self._problems = robot, person, random.problems
        self._speed = min(person.speed_share * robot.limits.vx_max, person.speed_most)

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index``; raise ImpossibleScenario when the world has no room for it."""
        name = f"{self._company.manner}/{index:04d}"
        return self._problems.scenario_with(name, (seed, index), self._with_person, TRIES)

    def _with_person(self, drawn: Scenario) -> Scenario | None:
        """Return the problem with the person, None where the person has no room."""
        grid = add_obstacles(add_furniture(drawn.world), drawn.obstacles)
        room = max(self._person.radius, self._robot.footprint.radius) + self._problems.trip.passage
        room -= self._robot.footprint.radius
        route = find_route(grid, room, drawn.start.array()[:2], drawn.goal.array()[:2])
        lengths = np.concatenate(((0.0,), np.hypot(*np.diff(route, axis=0).T).cumsum())) if len(route) else np.zeros(1)
        if lengths[-1] <= 2.0 * self._company.farthest:
            return None
        ahead = np.array([np.interp(self._company.distance, lengths, route[:, axis]) for axis in (0, 1)])
        leads = self._company.manner == "lead"
        robot_xy, person_xy = (ahead, route[0]) if leads else (route[0], ahead)
        if self._is_crowded(drawn, robot_xy, person_xy):
            return None
        heading = float(np.arctan2(*(ahead - route[0])[::-1]))
        person = PedestrianSpec(
            len(drawn.pedestrians),
            person_xy,
            drawn.goal.array()[None, :2],
            self._speed,
            self._person.radius,
            dict(FOLLOWER) if leads else {},
        )
        return replace(
            drawn,
            start=Pose(float(robot_xy[0]), float(robot_xy[1]), heading),
            pedestrians=(*drawn.pedestrians, person),
            company=replace(self._company, person=person.id),
        )

    def _is_crowded(self, drawn: Scenario, robot_xy: NDArray[np.float64], person_xy: NDArray[np.float64]) -> bool:
        """Return whether others stand too near to robot or person."""
        sizes = ((robot_xy, self._robot.footprint.radius), (person_xy, self._person.radius))
        return any(
            np.hypot(*(place - other.position_xy)) < size + other.radius + GAP
            for place, size in sizes
            for other in drawn.pedestrians
        )
