"""Random problems: a start, a goal and people on their rounds, drawn anew for each scenario."""

from __future__ import annotations

from arena_core import (
    ConfigurationError,
    Fraction,
    ImpossibleScenario,
    NonNegative,
    NonNegativeInt,
    PedestrianSpec,
    Positive,
    PositiveInt,
    Robot,
    Scenario,
    TaskMode,
    World,
    WorldSource,
    generator,
)
from arena_tasks.free_space import FreeSpace
from arena_tasks.trip import Trip, TripRules, draw_trip
from arena_tasks.walkers import Placement, WalkerRules, draw_walkers


class RandomTask(TaskMode):
    """Draws scenario ``index`` of a seed; every planner gets the same ones.

    ``clearance`` and ``keep_off`` count in robot radii, ``margin`` m is kept beyond all bodies. Start and goal are
    ``min_distance`` .. ``max_distance`` m apart (straight); ``shrink_to_world`` takes half the diagonal of the
    reachable space instead where that is less than ``min_distance``. With ``placement`` ``along_route``, people have their rounds on
    the robot's likely way, a share ``crossing`` of them across it and the others along it, up to ``reach`` m from where they belong.
    """

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        pedestrians: NonNegativeInt,
        pedestrian_speed: Positive,
        pedestrian_radius: Positive,
        waypoints_min: PositiveInt,
        waypoints_max: PositiveInt,
        placement: Placement,
        crossing: Fraction,
        reach: Positive,
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
        radius = robot.footprint.radius
        self._world = world
        self._trip = TripRules(max(clearance * radius, radius + margin), radius + margin, min_distance, max_distance, shrink_to_world)
        self._walkers = WalkerRules(
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
        )
        self._goal_radius = goal_radius
        self._time_limit = time_limit
        self._tries = tries

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index``; raise ImpossibleScenario when the world has no room for it."""
        name = f"random/{index:04d}"
        world = self._world.world(seed, index)
        trip, people = self._draw(name, seed, world)
        return Scenario(name, seed, world, trip.start, trip.goal, people, (), self._goal_radius, self._time_limit)

    def _draw(self, name: str, seed: int, world: World) -> tuple[Trip, tuple[PedestrianSpec, ...]]:
        random = generator(seed, name, "task")
        space = world.grid.derive(FreeSpace)
        for left in reversed(range(self._tries)):
            try:
                trip = draw_trip(space, self._trip, random, self._tries)
                return trip, draw_walkers(space, trip, self._walkers, random)
            except ImpossibleScenario as error:
                if left == 0:
                    raise ImpossibleScenario(f"{name} in world {world.name}: {error}") from None
        raise AssertionError("tries is at least 1")
