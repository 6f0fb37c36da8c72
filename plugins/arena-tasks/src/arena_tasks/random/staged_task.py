"""Random problems on levels of a curriculum: harder while the robot succeeds, easier when it fails."""

from __future__ import annotations

from dataclasses import dataclass, replace

from arena_core import ConfigurationError, InputFileError, Scenario, TaskMode, WorldSource
from arena_core.hosting import Staging
from arena_core.parameters import Fraction, NonNegativeInt, PositiveInt
from arena_tasks.random.curriculum import Curriculum, Level, read_curriculum
from arena_tasks.random.random_problems import RandomProblems
from arena_tasks.random.random_task import RandomTask


class StagedTask(TaskMode):
    """Problems of ``random``, with what the levels of the curriculum change; ``path`` is its file, or the name of a
    built-in one.

    After every ``block`` of episodes the level rises where the share of successes is ``promote`` or more, and falls
    where it is ``fall_back`` or less (Arena-Bench's staged training).
    """

    def __init__(
        self,
        world: WorldSource,
        path: str | None,
        start: NonNegativeInt,
        block: PositiveInt,
        promote: Fraction,
        fall_back: Fraction,
        random: TaskMode,
    ) -> None:
        if not isinstance(random, RandomTask):
            raise ConfigurationError("task.random.name is not random; allowed: random")
        curriculum = read_curriculum(path)
        self._staging = Staging(len(curriculum.levels), start, block, promote, fall_back)
        self._levels = [
            LevelTask(
                stage,
                level.speed_share,
                curriculum.content_hash,
                _level_problems(random.problems, world, level, curriculum),
            )
            for stage, level in enumerate(curriculum.levels)
        ]

    def staging(self) -> Staging:
        """Return when the level changes."""
        return self._staging

    def at_stage(self, stage: int) -> TaskMode:
        """Return the task of one level."""
        return self._levels[stage]

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index`` of the level that comes first."""
        return self._levels[self._staging.start].scenario(seed, index)


@dataclass(frozen=True, slots=True, eq=False)
class LevelTask(TaskMode):
    """The problems of one level."""

    stage: int
    speed_share: float
    content_hash: str
    problems: RandomProblems

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index`` of this level; raise ImpossibleScenario when the world has no room for it."""
        drawn = self.problems.scenario(f"staged/{self.stage}/{index:04d}", seed, index)
        return replace(drawn, speed_share=self.speed_share, stage=self.stage, content_hash=self.content_hash)


def _level_problems(usual: RandomProblems, world: WorldSource, level: Level, curriculum: Curriculum) -> RandomProblems:
    """Return the problems of a level; raise InputFileError where it asks for what the world or
    the random task does not have.
    """
    trip = replace(
        usual.trip,
        min_distance=usual.trip.min_distance if level.min_distance is None else level.min_distance,
        max_distance=usual.trip.max_distance if level.max_distance is None else level.max_distance,
    )
    if trip.min_distance > trip.max_distance:
        allowed = f"up to max_distance, {trip.max_distance:g} m"
        raise InputFileError(
            f"{curriculum.file}: {level.key}.min_distance is {trip.min_distance:g}; allowed: {allowed}"
        )
    return replace(
        usual,
        world=world if level.difficulty is None else _of_difficulty(world, level, curriculum),
        trip=trip,
        obstacles=replace(usual.obstacles, wanted=replace(usual.obstacles.wanted, count=level.obstacles)),
        walkers=replace(
            usual.walkers, count=level.pedestrians, people=replace(usual.walkers.people, speed=level.pedestrian_speed)
        ),
    )


def _of_difficulty(world: WorldSource, level: Level, curriculum: Curriculum) -> WorldSource:
    try:
        return world.at(level.difficulty or 0.0)
    except ConfigurationError as error:
        raise InputFileError(f"{curriculum.file}: {level.key}.{error}") from None
