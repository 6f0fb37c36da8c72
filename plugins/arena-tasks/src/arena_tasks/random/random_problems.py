"""Drawing random problems: a trip, obstacles on it, and people on their rounds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from arena_core import ImpossibleScenario, Obstacle, PedestrianSpec, Scenario, World, WorldSource, random_generator
from arena_core.scenes import add_furniture, add_obstacles
from arena_tasks.random.free_space import FreeSpace
from arena_tasks.random.obstacles import ObstacleRules, draw_obstacles
from arena_tasks.random.person_behaviour import with_behaviour
from arena_tasks.random.trip import Trip, TripRules, draw_trip
from arena_tasks.random.walkers import WalkerRules, draw_walkers


@dataclass(frozen=True, slots=True, eq=False)
class RandomProblems:
    """What random problems are made of; ``goal_radius`` m, ``time_limit`` s, and so many ``tries`` at each."""

    world: WorldSource
    trip: TripRules
    obstacles: ObstacleRules
    walkers: WalkerRules
    goal_radius: float
    time_limit: float
    tries: int

    def scenario(self, name: str, seed: int, index: int) -> Scenario:
        """Draw the problem of this name in world ``index``; raise ImpossibleScenario when the
        world has no room for it.
        """
        world = self.world.world(seed, index)
        trip, obstacles, people = self._draw_problem(name, seed, world)
        return Scenario(name, seed, world, trip.start, trip.goal, people, obstacles, self.goal_radius, self.time_limit)

    def scenario_with(
        self, name: str, world: tuple[int, int], join: Callable[[Scenario], Scenario | None], tries: int
    ) -> Scenario:
        """Return the first of so many problems in a world (seed, index) that ``join`` has room in, as it returns it;
        raise ImpossibleScenario when it has room in none.
        """
        for attempt in range(tries):
            drawn = self.scenario(f"{name}/{attempt}", *world)
            joined = join(replace(drawn, name=name))
            if joined is not None:
                return joined
        raise ImpossibleScenario(
            f"{name} in world {drawn.world.name}: no room for its people was found in {tries} problems"
        )

    def _draw_problem(
        self, name: str, seed: int, world: World
    ) -> tuple[Trip, tuple[Obstacle, ...], tuple[PedestrianSpec, ...]]:
        # obstacles shift no one's numbers
        random, aside = random_generator(seed, name, "task"), random_generator(seed, name, "obstacles")
        standing = add_furniture(world)
        space = standing.derive(FreeSpace)
        for left in reversed(range(self.tries)):
            try:
                trip = draw_trip(space, self.trip, random, self.tries)
                obstacles, onward = draw_obstacles(space, trip, self.obstacles, aside)
                among = add_obstacles(standing, obstacles).derive(FreeSpace)
                people = draw_walkers(among, onward, self.walkers, random)
                return (
                    trip,
                    obstacles,
                    with_behaviour(people, self.walkers.people, random_generator(seed, name, "manners")),
                )
            except ImpossibleScenario as error:
                if left == 0:
                    raise ImpossibleScenario(f"{name} in world {world.name}: {error}") from None
        raise AssertionError("tries is at least 1")
