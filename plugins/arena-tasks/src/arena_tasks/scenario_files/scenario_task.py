"""Problems from a file, in the order of the file, again and again."""

from __future__ import annotations

from bisect import bisect_right
from itertools import accumulate
from pathlib import Path

from arena_core import (
    ConfigurationError,
    ImpossibleScenario,
    InputFileError,
    Robot,
    Scenario,
    TaskMode,
    World,
    WorldSource,
)
from arena_core.commands import print_notice
from arena_core.files import local_path
from arena_core.parameters import Positive
from arena_core.scenes import add_furniture
from arena_tasks.scenario_files.content import content_hash
from arena_tasks.scenario_files.feasibility import Feasibility
from arena_tasks.scenario_files.pack import hash_of, verified_pack
from arena_tasks.scenario_files.problem import PersonDefaults, Problem, reading_notes
from arena_tasks.scenario_files.scenario_file import read_scenarios


class ScenarioTask(TaskMode):
    """Each problem comes as often as it says in a row, then the next one; each repetition has random streams of its
    own.

    ``path`` is a JSON file of any format of docs/formats.md; the map is ``world``'s, whatever the file says. What the
    file leaves open is ``pedestrian_speed`` m/s, ``pedestrian_radius`` m, ``goal_radius`` m and ``time_limit`` s. A
    file in a pack must be as it was packed. In a fixed world a problem that is impossible is left out and told; its
    file is refused only where none is possible.
    """

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        path: str | None,
        pedestrian_speed: Positive,
        pedestrian_radius: Positive,
        goal_radius: Positive,
        time_limit: Positive,
    ) -> None:
        if path is None:
            raise ConfigurationError("task.path is null; allowed: a scenario file, as in task.path=scenario.json")
        file = local_path(path)
        self._pack = verified_pack(file.parent)
        if self._pack:
            self._pack.check_lists(file)
        problems = _read_problems(file, PersonDefaults(pedestrian_speed, pedestrian_radius))
        checks = [Feasibility(file, problem, robot, problem.goal_radius or goal_radius) for problem in problems]
        first, other = world.world(0, 0), world.world(1, 1)
        # a fixed world: say what is impossible before anything runs
        if first.grid is other.grid and first.furniture == other.furniture:
            checks = possible_problems(checks, first)
        self._checks = checks
        self._robots = _robots_of(file, [check.problem for check in checks])
        self._ends = list(accumulate(check.problem.repeats for check in checks))
        self._file_hash = hash_of(file)
        self._world = world
        self._goal_radius = goal_radius
        self._time_limit = time_limit

    def robots(self) -> int:
        """Return how many robots each problem has."""
        return self._robots

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index``; raise ImpossibleScenario when it does not fit the world."""
        number, repetition = self._problem_place(index)
        problem, world = self._checks[number].problem, self._world.world(seed, index)
        world = problem.placed_in(world)
        add_furniture(world).derive(self._checks[number])
        return Scenario(
            name=f"{problem.name}/{repetition:04d}",
            seed=seed,
            world=world,
            start=problem.start,
            goal=problem.goal,
            pedestrians=problem.pedestrians,
            obstacles=problem.obstacles,
            doors=problem.doors,
            goal_radius=problem.goal_radius or self._goal_radius,
            time_limit=problem.time_limit or self._time_limit,
            company=problem.company,
            team=problem.team,
            content_hash=content_hash(self._file_hash, world.grid, self._pack),
        )

    def _problem_place(self, index: int) -> tuple[int, int]:
        """Return which problem comes at ``index``, and how often it came before."""
        rounds, position = divmod(index, self._ends[-1])
        number = bisect_right(self._ends, position)
        repeats = self._checks[number].problem.repeats
        return number, rounds * repeats + position - (self._ends[number] - repeats)


def _robots_of(file: Path, problems: list[Problem]) -> int:
    """Return how many robots each problem has; raise InputFileError where they differ."""
    counts = sorted({1 + len(problem.team) for problem in problems})
    if len(counts) > 1:
        raise InputFileError(
            f"{file}: its scenarios have {' and '.join(map(str, counts))} robots; allowed: one number in a file"
        )
    return counts[0]


def _read_problems(file: Path, defaults: PersonDefaults) -> tuple[Problem, ...]:
    """Read the problems of a file and tell what of it was not taken as written."""
    problems = read_scenarios(file, defaults)
    if notes := reading_notes(problems):
        print_notice(f"{file}: {notes}")
    return problems


def possible_problems(checks: list[Feasibility], world: World) -> list[Feasibility]:
    """Return those that hold in a world, in their order, and tell of each other; raise
    ImpossibleScenario where none holds.
    """
    reasons = [reason_against(check, world) for check in checks]
    possible = [check for check, reason in zip(checks, reasons, strict=True) if reason is None]
    if not possible:
        raise next(reason for reason in reasons if reason is not None)
    for check, reason in zip(checks, reasons, strict=True):
        if reason is not None:
            print_notice(f"{check.problem.name} is skipped, for it is impossible: {reason}")
    return possible


def reason_against(check: Feasibility, world: World) -> ImpossibleScenario | None:
    """Return why a problem is impossible in a world, None where it is not."""
    try:
        add_furniture(check.problem.placed_in(world)).derive(check)
    except ImpossibleScenario as error:
        return error
    return None
