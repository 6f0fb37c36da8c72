"""Whether a team has room: at its places, and beside each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations

from arena_core import ImpossibleScenario, OccupancyGrid, Pose, Robot
from arena_core.tasks import Member
from arena_kernels.distance import grid_distance


def make_team(ways: Sequence[tuple[Pose, Pose]], teammates: str | None) -> tuple[Member, ...]:
    """Return all but the first of these ways, (start, goal), as teammates that drive with the planner of that name;
    None: with the run's.
    """
    return tuple(
        Member(f"robot{number}", start, goal, teammates or "") for number, (start, goal) in enumerate(ways[1:], 1)
    )


def check_room(name: str, grid: OccupancyGrid, ways: Sequence[tuple[Pose, Pose]], robot: Robot) -> None:
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
