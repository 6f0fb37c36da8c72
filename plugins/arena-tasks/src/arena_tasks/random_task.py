"""Random problems: a start, a goal, obstacles and people on their rounds, drawn anew for each scenario."""

from __future__ import annotations

from arena_core import (
    ConfigurationError,
    Fraction,
    NonNegative,
    NonNegativeInt,
    Positive,
    PositiveInt,
    Robot,
    Scenario,
    TaskMode,
    WorldSource,
)
from arena_tasks.obstacles import ObstacleRules
from arena_tasks.random_problems import RandomProblems
from arena_tasks.trip import Placement, TripRules
from arena_tasks.walkers import WalkerRules


class RandomTask(TaskMode):
    """Draws scenario ``index`` of a seed; every planner gets the same ones.

    ``clearance`` and ``keep_off`` count in robot radii, ``margin`` m is kept beyond all bodies. Start and goal are
    ``min_distance`` .. ``max_distance`` m apart (straight); ``shrink_to_world`` takes half the diagonal of the
    reachable space instead where that is less than ``min_distance``. With ``placement`` ``along_route``, people have their rounds on
    the robot's likely way, a share ``crossing`` of them across it and the others along it, up to ``reach`` m from where they belong,
    and obstacles stand on it or beside it. ``problems`` is what the scenarios are made of.
    """

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        pedestrians: NonNegativeInt,
        pedestrian_speed: Positive,
        pedestrian_radius: Positive,
        children: Fraction,
        elders: Fraction,
        respawn: bool,
        waypoints_min: PositiveInt,
        waypoints_max: PositiveInt,
        placement: Placement,
        crossing: Fraction,
        reach: Positive,
        obstacles: NonNegativeInt,
        obstacle_radius_min: Positive,
        obstacle_radius_max: Positive,
        polygons: Fraction,
        min_distance: Positive,
        max_distance: Positive,
        shrink_to_world: bool,
        clearance: NonNegative,
        keep_off: NonNegative,
        margin: NonNegative,
        goal_radius: Positive,
        time_limit: Positive,
        tries: PositiveInt,
    ) -> None:
        if not 2 <= waypoints_min <= waypoints_max:
            raise ConfigurationError(
                f"task.waypoints_min is {waypoints_min} and waypoints_max {waypoints_max}; allowed: 2 <= waypoints_min <= waypoints_max"
            )
        if min_distance > max_distance:
            raise ConfigurationError(f"task.min_distance is {min_distance:g}; allowed: up to max_distance, {max_distance:g} m")
        if obstacle_radius_min > obstacle_radius_max:
            raise ConfigurationError(
                f"task.obstacle_radius_min is {obstacle_radius_min:g}; allowed: up to obstacle_radius_max, {obstacle_radius_max:g} m"
            )
        if children + elders > 1.0:
            raise ConfigurationError(f"task.elders is {elders:g}; allowed: up to {1.0 - children:g}, what the children leave")
        radius = robot.footprint.radius
        trip = TripRules(max(clearance * radius, radius + margin), radius + margin, min_distance, max_distance, shrink_to_world)
        walkers = WalkerRules(
            count=pedestrians,
            speed=pedestrian_speed,
            radius=pedestrian_radius,
            clearance=pedestrian_radius + margin,
            keep_off=pedestrian_radius + keep_off * radius,
            waypoints_min=waypoints_min,
            waypoints_max=waypoints_max,
            placement=placement,
            crossing=crossing,
            reach=reach,
            respawn=respawn,
            children=children,
            elders=elders,
        )
        standing = ObstacleRules(
            count=obstacles,
            radius_min=obstacle_radius_min,
            radius_max=obstacle_radius_max,
            polygons=polygons,
            keep_off=max(keep_off * radius, trip.clearance),
            passage=trip.passage,
            placement=placement,
            reach=reach,
        )
        self.problems = RandomProblems(world, trip, standing, walkers, goal_radius, time_limit, tries)

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index``; raise ImpossibleScenario when the world has no room for it."""
        return self.problems.scenario(f"random/{index:04d}", seed, index)
