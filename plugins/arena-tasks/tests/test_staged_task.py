"""Levels change what they name and nothing else, and every slip in a curriculum is one line before anything runs."""

from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from arena_core import ConfigurationError, InputFileError, World, WorldSource, testing
from arena_core.testing import check, component
from arena_tasks.random.curriculum import built_in, read_curriculum
from arena_tasks.random.random_task import RandomTask
from arena_tasks.random.staged_task import StagedTask

LEVEL = {"difficulty": None, "obstacles": 0, "pedestrians": 0, "pedestrian_speed": 0.3, "speed_share": 1.0}


class Halls(WorldSource):
    """Give rooms that are smaller the more difficult they are."""

    def __init__(self, difficulty: float = 0.0) -> None:
        self.difficulty = difficulty

    def world(self, seed: int, index: int) -> World:
        return World(f"hall/{self.difficulty:g}", testing.room(20.0 - 10.0 * self.difficulty))

    def at(self, difficulty: float) -> WorldSource:
        return Halls(difficulty)


class Fixed(WorldSource):
    def world(self, seed: int, index: int) -> World:
        return World("fixed", testing.room(20.0))


def usual(world: WorldSource, **changes: object) -> RandomTask:
    task = component(
        "task", "random", [f"task.{k}={v}" for k, v in changes.items()], robot=testing.robot(), world=world
    )
    assert isinstance(task, RandomTask)
    return task


def staged(path: str | None = None, world: WorldSource | None = None, **changes: Any) -> StagedTask:
    figures = {"start": 0, "block": 20, "promote": 0.85, "fall_back": 0.6, **changes}
    world = world or Halls()
    return StagedTask(world, path, random=usual(world), **figures)


def write(folder: Path, *levels: dict[str, Any], **content: Any) -> str:
    path = folder / "my.yaml"
    path.write_text(yaml.safe_dump({"levels": dict(enumerate(levels)), **content}))
    return str(path)


def test_it_holds_the_contract_of_a_task() -> None:
    assert check("task", staged(), testing.robot())


def test_the_released_curriculum_is_the_usual_one() -> None:
    task = staged()
    scenarios = [task.at_stage(stage).scenario(0, 0) for stage in range(task.staging().levels)]
    found = [(len(s.obstacles), len(s.pedestrians)) for s in scenarios]
    assert found == [(0, 0), (0, 4), (1, 4), (1, 6), (1, 8), (2, 7), (2, 10)]
    assert [s.stage for s in scenarios] == list(range(7))


@pytest.mark.parametrize("name", built_in())
def test_built_in_curricula_can_be_driven(name: str) -> None:
    task = staged(name)
    levels = task.staging().levels
    assert levels >= 7
    assert len({task.at_stage(stage).scenario(3, 1).content_hash for stage in range(levels)}) == 1


def test_no_level_of_a_built_in_curriculum_has_less_of_everything_than_the_one_before() -> None:
    for name in built_in():
        levels = read_curriculum(name).levels
        for before, after in pairwise(levels):
            assert (after.difficulty or 0.0) >= (before.difficulty or 0.0)
            assert after.obstacles + after.pedestrians >= before.obstacles + before.pedestrians


def test_a_level_changes_what_it_names_and_nothing_else(tmp_path: Path) -> None:
    hard = {"difficulty": 0.5, "obstacles": 2, "pedestrians": 3, "pedestrian_speed": 0.9, "speed_share": 0.5}
    task = staged(write(tmp_path, LEVEL, {**hard, "min_distance": 4.0, "max_distance": 6.0}))
    easy, scenario = task.at_stage(0).scenario(2, 5), task.at_stage(1).scenario(2, 5)
    assert (easy.world.name, easy.speed_share, easy.stage, easy.pedestrians, easy.obstacles) == (
        "hall/0",
        1.0,
        0,
        (),
        (),
    )
    assert (scenario.world.name, scenario.speed_share, scenario.stage, len(scenario.obstacles)) == (
        "hall/0.5",
        0.5,
        1,
        2,
    )
    assert [p.desired_speed for p in scenario.pedestrians] == [0.9] * 3
    assert 4.0 <= scenario.start.distance(scenario.goal) <= 6.0 < 10.0 <= easy.start.distance(easy.goal)
    assert (scenario.goal_radius, scenario.time_limit) == (easy.goal_radius, easy.time_limit) == (0.3, 180.0)
    assert (scenario.name, task.scenario(2, 5).name) == ("staged/1/0005", "staged/0/0005")


def test_content_of_the_curriculum_has_a_name(tmp_path: Path) -> None:
    one = staged(write(tmp_path, LEVEL)).scenario(0, 0).content_hash
    assert len(one) == 12
    assert staged(write(tmp_path, {**LEVEL, "speed_share": 0.9})).scenario(0, 0).content_hash != one


@pytest.mark.parametrize(
    ("levels", "message"),
    [
        (
            {0: dict(LEVEL), 1: dict(LEVEL), 3: LEVEL},
            r"levels are numbered 0, 1, 3; allowed: 0, 1, 2 and so on without a gap",
        ),
        ({1: dict(LEVEL), 2: LEVEL}, r"levels are numbered 1, 2; allowed: 0, 1, 2 and so on"),
        ({"easy\n": LEVEL}, r'levels are numbered "easy\\n"; allowed: 0'),
        ({}, r"levels is \{\}; allowed: at least one level"),
        ([], r"levels is \[\]; allowed: at least one level"),
        (None, r"levels is null; allowed: at least one level"),
        ([LEVEL], r"levels is \[.*; allowed: a mapping"),
        ({0: 3}, r"levels\.0 is 3; allowed: a mapping"),
        ({0: {k: v for k, v in LEVEL.items() if k != "pedestrians"}}, r"levels\.0\.pedestrians is missing"),
        ({0: {**LEVEL, "people": 3}}, r"levels\.0\.people is unknown; allowed: difficulty, obstacles, "),
        ({0: {**LEVEL, "difficulty": 1.1}}, r"levels\.0\.difficulty is 1\.1; allowed: a number >= 0 and <= 1"),
        ({0: LEVEL, 1: {**LEVEL, "obstacles": -1}}, r"levels\.1\.obstacles is -1; allowed: a whole number 0 \.\. 1000"),
        ({0: {**LEVEL, "pedestrians": 2.5}}, r"levels\.0\.pedestrians is 2\.5; allowed: a whole number"),
        ({0: {**LEVEL, "pedestrian_speed": 0}}, r"levels\.0\.pedestrian_speed is 0; allowed: a number > 0"),
        ({0: {**LEVEL, "speed_share": 1.5}}, r"levels\.0\.speed_share is 1\.5; allowed: a number > 0 and <= 1"),
        ({0: {**LEVEL, "speed_share": 0.0}}, r"levels\.0\.speed_share is 0\.0; allowed: a number > 0 and <= 1"),
        ({0: {**LEVEL, "speed_share": float("nan")}}, r"levels\.0\.speed_share is NaN; allowed: a number > 0 and <= 1"),
        ({0: {**LEVEL, "min_distance": 30.0}}, r"levels\.0\.min_distance is 30; allowed: up to max_distance, 20 m"),
    ],
)
def test_every_slip_is_one_line_with_file_and_key(tmp_path: Path, levels: Any, message: str) -> None:
    path = tmp_path / "my.yaml"
    path.write_text(yaml.safe_dump({"levels": levels}))
    with pytest.raises(InputFileError, match=rf"my\.yaml: {message}") as caught:
        staged(str(path))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"levels: [", r"my\.yaml: is no YAML \("),
        (b"\xff\xfe\x00", r"my\.yaml: is no YAML \("),
        (b"", r"my\.yaml: content is null; allowed: a mapping"),
        (b"levels: {0: {}, 0: {}}", r"my\.yaml: is no YAML \(0 is there twice"),
        (b"stages: {}", r"my\.yaml: stages is unknown; allowed: levels"),
        (b"{}", r"my\.yaml: levels is missing"),
        (b"levels: {? [1] : 2}", r"my\.yaml: "),
    ],
)
def test_what_is_no_curriculum_is_named(tmp_path: Path, content: bytes, message: str) -> None:
    (tmp_path / "my.yaml").write_bytes(content)
    with pytest.raises(InputFileError, match=message) as caught:
        read_curriculum(str(tmp_path / "my.yaml"))
    assert "\n" not in str(caught.value)


def test_a_file_that_is_not_there_is_named_with_the_built_in_ones() -> None:
    with pytest.raises(InputFileError, match=r"nowhere\.yaml: cannot be read .* or one of growing, released"):
        read_curriculum("nowhere.yaml")


def test_a_world_without_difficulty_is_named_with_file_and_level(tmp_path: Path) -> None:
    path = write(tmp_path, LEVEL, {**LEVEL, "difficulty": 0.3})
    with pytest.raises(
        InputFileError, match=r"my\.yaml: levels\.1\.difficulty is 0\.3, but this world has none; allowed: "
    ):
        staged(path, Fixed())


def test_only_random_problems_have_levels() -> None:
    barn = component("task", "barn", robot=testing.robot(), world=Halls())
    with pytest.raises(ConfigurationError, match=r"task\.random\.name is not random"):
        StagedTask(Halls(), None, 0, 20, 0.85, 0.6, barn)


def test_a_rule_that_contradicts_itself_is_refused() -> None:
    with pytest.raises(ConfigurationError, match=r"task\.promote is 0\.6; allowed: above task\.fall_back, 0\.6"):
        staged(promote=0.6)
    with pytest.raises(ConfigurationError, match=r"task\.start is 7; allowed: 0 \.\. 6"):
        staged(start=7)


def test_levels_draw_alike_in_every_process() -> None:
    one, other = staged(), staged()
    first, second = (task.at_stage(5).scenario(1, 3) for task in (one, other))
    assert (first.start, first.goal) == (second.start, second.goal)
    same = [
        np.array_equal(a.vertices_xy, b.vertices_xy) for a, b in zip(first.obstacles, second.obstacles, strict=True)
    ]
    assert same == [True, True]


def test_the_preset_has_the_curricula_that_it_names() -> None:
    text = (files("arena_tasks.conf") / "task" / "staged.yaml").read_text()
    assert all(name in text for name in built_in())


def test_curriculum_may_lie_in_a_package():
    addressed, named = read_curriculum("pkg://arena_tasks/curricula/growing.yaml"), read_curriculum("growing")
    assert (addressed.content_hash, addressed.levels) == (named.content_hash, named.levels)
