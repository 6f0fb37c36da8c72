"""Problems to train on, drawn once and kept, for planning a path takes as long as many steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ConfigurationError,
    GlobalPlanner,
    ImpossibleScenario,
    NoPath,
    Path,
    PathBatch,
    Scenario,
    Simulator,
    TaskMode,
    WaypointGenerator,
    World,
    WorldSource,
)
from arena_core.hosting import Staging
from arena_gym.seeds import FIRST_TRAINING_SEED, training_seed
from arena_kernels.paths import lengths_left

TRIES = 20  # of problems in a world, and of worlds
CHECKED = 3  # worlds that have no problem before a training says so at its start
Floats = NDArray[np.float64]
_SLOT = np.zeros(1, np.int64)


class PooledWorlds(WorldSource):
    """A few worlds of a source, each made once; problem ``index`` lies in world ``index`` modulo their number."""

    def __init__(self, source: WorldSource, worlds: int) -> None:
        self._source, self._number = source, worlds
        self._made: dict[tuple[int, int], World] = {}

    def world(self, seed: int, index: int) -> World:
        """Return the world of a problem; ``seed`` is a training seed without world."""
        key = seed, index % self._number
        if key not in self._made:
            self._made[key] = self._source.world(seed + key[1], key[1])
        return self._made[key]

    def at(self, difficulty: float) -> WorldSource:
        """Return as many worlds of another difficulty."""
        return PooledWorlds(self._source.at(difficulty), self._number)


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """A scenario, the way to its goal, the length of it that is left from each pose
    (M,), m, and the first waypoint (3,). ``mates`` are those of the other robots of a team.
    """

    scenario: Scenario
    path: Path
    left: Floats
    waypoint: Floats
    mates: tuple[Problem, ...] = ()


class ProblemPool:
    """``size`` problems of a training seed in so many ``worlds``, drawn when first asked for.

    ``waypoints`` and ``simulator`` are the pool's own: each problem begins in them once, so that it cannot fail in
    training.
    """

    def __init__(
        self,
        task: TaskMode,
        planner: GlobalPlanner,
        waypoints: WaypointGenerator,
        simulator: Simulator,
        seed: int,
        worlds: int,
        size: int,
    ) -> None:
        self._task, self._planner, self._waypoints, self._simulator = task, planner, waypoints, simulator
        self._seed, self._worlds = seed, worlds
        self.size = min(size, task.count() or size)
        self._problems: dict[int, Problem] = {}
        self._reasons: dict[int, str] = {}  # why problems were not drawn
        self._levels: dict[int, ProblemPool] = {}

    @property
    def robots(self) -> int:
        """Return how many robots a problem has."""
        return self._task.robots()

    @property
    def staging(self) -> Staging | None:
        """Return the rule of a task with levels."""
        return self._task.staging()

    def at_stage(self, stage: int) -> ProblemPool:
        """Return the problems of one level of the task, always the same pool; raise
        ConfigurationError where there is no such level.
        """
        levels = self.staging.levels if self.staging else 0
        if not 0 <= stage < levels:
            raise ConfigurationError(
                f"stage is {stage}; allowed: {f'0 .. {levels - 1}' if levels else 'none, this task has no levels'}"
            )
        if stage not in self._levels:
            parts = self._planner, self._waypoints, self._simulator
            self._levels[stage] = ProblemPool(self._task.at_stage(stage), *parts, self._seed, self._worlds, self.size)
        return self._levels[stage]

    def problem(self, index: int) -> Problem:
        """Return problem ``index``, or that of the next world which has one; raise
        ImpossibleScenario when many in a row have none.
        """
        if index not in self._problems:
            self._problems[index] = self._first_possible(index, TRIES)
        return self._problems[index]

    def check(self) -> None:
        """Raise ImpossibleScenario where the first worlds have no problem: no one waits for all of them to be tried."""
        self._first_possible(0, CHECKED)

    def fill(self, progress: Callable[[int], None] = lambda drawn: None) -> None:
        """Draw all problems now; ``progress`` hears how many there are."""
        for index in range(self.size):
            self.problem(index)
            progress(index + 1)

    def _first_possible(self, index: int, worlds: int) -> Problem:
        """Return this problem, or one of the next world that has any, of so many; which one depends on
        nothing that was drawn before.
        """
        reason = ""
        for place in range(index, index + worlds):
            first = place % self._worlds
            if first not in self._problems and first not in self._reasons:
                self._try_problem(first)
            if first not in self._reasons and (place in self._problems or self._try_problem(place)):
                return self._problems[place]
            reason = self._reasons[first if first in self._reasons else place]
        raise ImpossibleScenario(
            f"problem {index} and those of {worlds - 1} more worlds cannot be trained on: {reason}"
        )

    def _try_problem(self, index: int) -> bool:
        """Draw this problem, or the next one in its world that has a solution; keep it, or the
        reason why there is none.
        """
        if index in self._reasons:
            return False
        count, reason = self._task.count(), ""
        for attempt in range(TRIES):
            number = index + attempt * self.size
            try:
                self._problems[index] = self._draw_problem(number if count is None else number % count)
                return True
            except (ImpossibleScenario, NoPath) as error:
                reason = str(error)
        self._reasons[index] = reason
        return False

    def _draw_problem(self, index: int) -> Problem:
        scenario = self._task.scenario(training_seed(self._seed), index)
        assert scenario.seed >= FIRST_TRAINING_SEED, (
            f"{scenario.name} has seed {scenario.seed}, which evaluation may use"
        )
        _check_can_be_trained(scenario)
        self._simulator.reset([scenario])
        mates = tuple(self._plan(scenario.seen_by(member)) for member in range(1, scenario.robots))
        return replace(self._plan(scenario), mates=mates)

    def _plan(self, scenario: Scenario) -> Problem:
        """Return the problem of a scenario's first robot, with its way."""
        path = self._planner.plan(scenario.world.grid, scenario.start, scenario.goal)
        packed = PathBatch.of([path])
        left = np.empty(len(path.poses))
        lengths_left(packed.poses, packed.offsets, left)
        self._waypoints.reset(_SLOT, 1)
        found = self._waypoints.next(packed, scenario.start.array()[None], np.zeros(1))
        return Problem(scenario, path, left, found.poses[0].copy())


def _check_can_be_trained(scenario: Scenario) -> None:
    """Raise ConfigurationError for a scenario that cannot be trained on: its goals move, or robots are of several
    types.
    """
    if scenario.company is not None:
        raise ConfigurationError(
            f"{scenario.name}: its goal moves with a person; allowed in training: tasks whose goal stays"
        )
    if scenario.errands is not None:
        raise ConfigurationError(
            f"{scenario.name}: its robots run errands; allowed in training: tasks whose goals stay"
        )
    if kind := next((mate.robot for mate in scenario.team if mate.robot), ""):
        raise ConfigurationError(f"{scenario.name}: a robot is a {kind}; allowed in training: teams of one type")
