"""Random problems: a start, a goal, obstacles and people on their rounds, drawn again for each scenario."""

from __future__ import annotations

from arena_core import Robot, Scenario, TaskMode, WorldSource
from arena_core.parameters import Count, Positive, Samples
from arena_tasks.random.obstacles import ObstacleRules
from arena_tasks.random.random_problems import RandomProblems
from arena_tasks.random.trip import Placement, TripRules
from arena_tasks.random.walkers import WalkerRules
from arena_tasks.random_parameters import (
    GroupParameters,
    ObstacleParameters,
    PeopleParameters,
    RoundParameters,
    TripParameters,
)


class RandomTask(TaskMode):
    """Draws scenario ``index`` of a seed; every planner gets the same ones.

    With ``placement`` ``along_route`` the rounds of the ``pedestrians`` people and the obstacles lie on the robot's
    likely way. ``problems`` is what the scenarios are made of.
    """

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        pedestrians: Count,
        placement: Placement,
        goal_radius: Positive,
        time_limit: Positive,
        tries: Samples,
        people: PeopleParameters,
        groups: GroupParameters,
        rounds: RoundParameters,
        obstacles: ObstacleParameters,
        trip: TripParameters,
    ) -> None:
        radius = robot.footprint.radius
        passage, keep_off = radius + trip.margin, trip.keep_off * radius
        ends = max(trip.clearance * radius, passage)
        self.problems = RandomProblems(
            world,
            TripRules(ends, passage, trip.min_distance, trip.max_distance, trip.shrink_to_world),
            ObstacleRules(obstacles, placement, max(keep_off, ends), passage),
            WalkerRules(
                pedestrians, people.radius + trip.margin, people.radius + keep_off, people, groups, rounds, placement
            ),
            goal_radius,
            time_limit,
            tries,
        )

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index``; raise ImpossibleScenario when the world has no room for it."""
        return self.problems.scenario(f"random/{index:04d}", seed, index)
