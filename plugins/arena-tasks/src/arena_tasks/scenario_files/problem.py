"""A problem as a scenario file states it, before it meets a world."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace

from arena_core import Furniture, Obstacle, PedestrianSpec, Pose, World
from arena_core.scenes import Door
from arena_core.tasks import Company, Member

MOST_REPEATS = 1_000_000


@dataclass(frozen=True, slots=True)
class PersonDefaults:
    """What a person is where the file does not say: ``speed`` m/s, ``radius`` m."""

    speed: float
    radius: float


@dataclass(frozen=True, slots=True)
class Keys:
    """Where in the file the parts of a problem stand, for errors: '{file}: {key}'."""

    start: str
    goal: str
    people: tuple[str, ...]
    team: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """Start, goal, people, obstacles, doors and furniture in ``map``; ``goal_radius`` (m) or ``time_limit`` (s) is None
    where the task decides.

    ``team`` are the robots beside the first one. ``company`` is the person whom the robot is to keep with, if there is
    one. It comes ``repeats`` times before the next problem of its file. ``notes`` say in words what of the file was not
    taken as written.
    """

    name: str
    start: Pose
    goal: Pose
    pedestrians: tuple[PedestrianSpec, ...]
    obstacles: tuple[Obstacle, ...]
    goal_radius: float | None
    time_limit: float | None
    keys: Keys
    repeats: int = 1
    notes: tuple[str, ...] = ()
    furniture: tuple[Furniture, ...] = ()
    company: Company | None = None
    doors: tuple[Door, ...] = ()
    team: tuple[Member, ...] = ()

    def ways(self) -> list[tuple[str, Pose, str, Pose]]:
        """Return start and goal of every robot, each behind where it stands in the file."""
        mates = zip(self.keys.team, self.team, strict=True)
        others = [(f"{key}.start", mate.start, f"{key}.goal", mate.goal) for key, mate in mates]
        return [(self.keys.start, self.start, self.keys.goal, self.goal), *others]

    def placed_in(self, world: World) -> World:
        """Return the world with the problem's own furniture beside that of the world."""
        return replace(world, furniture=world.furniture + self.furniture) if self.furniture else world


def reading_notes(problems: Iterable[Problem]) -> str:
    """Return what of some problems was not taken as written, in one line; empty where all was."""
    counts = Counter(note for problem in problems for note in problem.notes)
    return "; ".join(note if count == 1 else f"{note}, {count} times" for note, count in counts.items())
