"""What tasks of teams have in common: how many robots, what drives them, and whether they have room."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Annotated

from arena_core import ImpossibleScenario, OccupancyGrid, Pose, Robot, Scenario, World
from arena_core.files import LIMITS
from arena_core.parameters import Bounds, Positive
from arena_core.tasks import Member
from arena_kernels.distance import grid_distance

TeamSize = Annotated[int, Bounds(low=2, high=LIMITS.robots)]
Ways = Sequence[tuple[Pose, Pose]]  # start and goal of each robot


@dataclass(frozen=True, slots=True)
class TeamRules:
    """``team`` robots, all but the first with the planner ``teammates`` and of the type ``teammates_robot`` (None: the
    run's); ``goal_radius`` m, ``time_limit`` s.
    """

    team: TeamSize
    teammates: str | None
    teammates_robot: str | None
    goal_radius: Positive
    time_limit: Positive

    def scenario(self, name: str, seed: int, world: World, ways: Ways) -> Scenario:
        """Return a scenario without people in which robots have these ways."""
        (start, goal), *others = ways
        return Scenario(
            name, seed, world, start, goal, (), (), self.goal_radius, self.time_limit, team=self.members(others)
        )

    def members(self, ways: Ways) -> tuple[Member, ...]:
        """Return the robots beside the first one, which have these ways."""
        kind = (self.teammates or "", self.teammates_robot or "")
        return tuple(Member(f"robot{k}", *way, *kind) for k, way in enumerate(ways, 1))


def check_room(name: str, grid: OccupancyGrid, ways: Ways, robot: Robot) -> None:
    """Raise ImpossibleScenario where a robot has no room at its start or goal, or two of them would overlap there."""
    radius = robot.footprint.radius
    for what, places in (("starts", [start for start, _ in ways]), ("goals", [goal for _, goal in ways])):
        away = grid.derive(grid_distance)
        for number, place in enumerate(places):
            row, column = grid.cells((place.x, place.y)).tolist()
            inside = 0 <= row < away.shape[0] and 0 <= column < away.shape[1]
            if not inside or away[row, column] < radius + grid.resolution:
                raise ImpossibleScenario(
                    f"{name}: robot {number} of {len(ways)} has no room at ({place.x:.2f}, {place.y:.2f}); allowed: "
                    f"{what} that are {radius:.2f} m and more off walls, as in world=empty"
                )
        near = min((a.distance(b) for a, b in combinations(places, 2)), default=math.inf)
        if near < 2.0 * radius:
            raise ImpossibleScenario(
                f"{name}: {len(ways)} robots have {what} {near:.2f} m apart; allowed: {2.0 * radius:.2f} m and more, "
                "with fewer robots or a larger task.radius or task.spacing"
            )
