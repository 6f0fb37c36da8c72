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
from arena_tasks.manners import FARTHEST, MannerRules
from arena_tasks.obstacles import ObstacleRules
from arena_tasks.random_problems import RandomProblems
from arena_tasks.rounds import RoundRules
from arena_tasks.trip import Placement, TripRules
from arena_tasks.walkers import GroupRules, WalkerRules

LEAST_SPREAD_REFUSED = 1.0 / FARTHEST


class RandomTask(TaskMode):
    """Draws scenario ``index`` of a seed; every planner gets the same ones.

    ``clearance`` and ``keep_off`` count in robot radii, ``margin`` m is kept beyond all bodies. Start and goal are
    ``min_distance`` .. ``max_distance`` m apart (straight); ``shrink_to_world`` takes half the diagonal of the
    reachable space instead where that is less than ``min_distance``. People walk rounds of waypoints that are ``leg_min`` .. ``leg_max`` m
    apart (straight), a share ``to_and_fro`` of them back the same way. With ``placement`` ``along_route``, a share ``meeting`` of the
    rounds comes to the robot's likely way, of these a share ``crossing`` from one side of it to the other, the others along it, and
    obstacles stand up to ``reach`` m from it. ``problems`` is what the scenarios are made of.
    """

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        pedestrians: NonNegativeInt,
        pedestrian_speed: Positive,
        pedestrian_speed_spread: Fraction,
        pedestrian_radius: Positive,
        children: Fraction,
        elders: Fraction,
        grouped: Fraction,
        group_min: PositiveInt,
        group_max: PositiveInt,
        pause_probability: Fraction,
        pause_time: NonNegative,
        respawn: bool,
        waypoints_min: PositiveInt,
        waypoints_max: PositiveInt,
        leg_min: Positive,
        leg_max: Positive,
        to_and_fro: Fraction,
        placement: Placement,
        meeting: Fraction,
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
        _check_order("waypoints", waypoints_min, waypoints_max, 2)
        _check_order("leg", leg_min, leg_max)
        _check_order("group", group_min, group_max, 2)
        _check_order("obstacle_radius", obstacle_radius_min, obstacle_radius_max)
        if min_distance > max_distance:
            raise ConfigurationError(f"task.min_distance is {min_distance:g}; allowed: up to max_distance, {max_distance:g} m")
        if children + elders > 1.0:
            raise ConfigurationError(f"task.elders is {elders:g}; allowed: up to {1.0 - children:g}, what the children leave")
        if pedestrian_speed_spread >= LEAST_SPREAD_REFUSED:
            allowed = f"below {LEAST_SPREAD_REFUSED:g}, or somebody would not walk at all"
            raise ConfigurationError(f"task.pedestrian_speed_spread is {pedestrian_speed_spread:g}; allowed: {allowed}")
        radius = robot.footprint.radius
        trip = TripRules(max(clearance * radius, radius + margin), radius + margin, min_distance, max_distance, shrink_to_world)
        walkers = WalkerRules(
            count=pedestrians,
            speed=pedestrian_speed,
            radius=pedestrian_radius,
            clearance=pedestrian_radius + margin,
            keep_off=pedestrian_radius + keep_off * radius,
            rounds=RoundRules(waypoints_min, waypoints_max, leg_min, leg_max, to_and_fro, placement, meeting, crossing),
            groups=GroupRules(grouped, group_min, group_max),
            manners=MannerRules(children, elders, respawn, pedestrian_speed_spread, pause_probability, pause_time),
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


def _check_order(name: str, least: float, greatest: float, lowest: int | None = None) -> None:
    """Raise ConfigurationError unless NAME_min is no more than NAME_max, and no less than ``lowest``."""
    if least <= greatest and (lowest is None or least >= lowest):
        return
    allowed = f"{name}_min <= {name}_max" if lowest is None else f"{lowest} <= {name}_min <= {name}_max"
    raise ConfigurationError(f"task.{name}_min is {least:g} and {name}_max {greatest:g}; allowed: {allowed}")
