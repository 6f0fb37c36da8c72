"""One pack of several searches: shares, names, what is refused, and what it says about the searches."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml

from arena_break.joining import join_packs
from arena_break.results import COLUMNS, SEED_STEP, renamed
from arena_core import ConfigurationError, OccupancyGrid, Pose
from arena_tasks.commands.packing import ANYBODY, make_pack
from arena_tasks.scenario_files.pack import verified_pack
from arena_tasks.scenario_files.problem import Keys, Problem
from arena_tasks.scenario_files.scenario_file import read_scenario_file, save_scenarios
from arena_worlds.formats.map_writer import write_map

PROBLEM = Problem("p", Pose(1.0, 1.0, 0.0), Pose(5.0, 1.0, 0.0), (), (), None, 30.0, Keys("start", "goal", ()))


@pytest.fixture
def searched(tmp_path) -> Callable[..., Path]:
    """Return the folder of a finished search that found ``count`` problems, in a hall so many cells wide."""

    def _searched(preset: str, seed: int, count: int, *, wide: int = 60) -> Path:
        place, name = tmp_path / f"{preset}_{seed}_{wide}", f"{preset}_jackal"
        problems = renamed([PROBLEM] * count, name, seed)
        for folder in ("maps", "scenarios"):
            (place / "pack" / folder).mkdir(parents=True)
        grid = OccupancyGrid(np.zeros((30, wide), np.int8), 0.1, Pose(0.0, 0.0, 0.0))
        write_map(place / "pack/maps/hall.yaml", grid)
        if problems:
            save_scenarios(place / f"pack/scenarios/{name}.json", problems, "some", "../maps/hall.yaml")
            make_pack(place / "pack", {"id": f"hard_{name}"})
        facts = {"preset": preset, "robot": "jackal", "world": "hall", "seed": seed, "budget": 48, "count": 12}
        rows = [{**dict.fromkeys(COLUMNS, ""), "name": one.name} for one in problems]
        more = {"code": "abc", "words": ["tracker=legs"], "bounds": {"batch": 24}, "search": {"failures": 9, "hard": 5}}
        (place / "card.json").write_text(json.dumps({**facts, **more, "problems": rows}))
        return place

    return _searched


def names_in(pack: Path) -> list[str]:
    """Return the names of a pack's problems in their order."""
    return [one.name for one in read_scenario_file(pack / "scenarios/jackal_hall.json", ANYBODY).problems]


def test_searches_of_several_seeds_fill_a_share_and_what_has_fewer_is_said(searched, tmp_path):
    folders = [searched("a", 0, 3), searched("b", 0, 2), searched("a", 1, 4)]
    said = join_packs(folders, tmp_path / "hard", 5)
    assert said[0].endswith("hard: 7 problems: 5 against a on jackal, 2 against b on jackal")
    mine = [f"a_jackal_{number:02d}" for number in (0, 1, 2, SEED_STEP, SEED_STEP + 1)]
    assert names_in(tmp_path / "hard") == [*mine[:3], "b_jackal_00", "b_jackal_01", *mine[3:]]
    assert verified_pack(tmp_path / "hard").title == (
        "7 certified hard problems: 5 against a on jackal, 2 against b on jackal"
    )


def test_without_a_share_all_have_as_many_as_the_fewest(searched, tmp_path):
    join_packs([searched("a", 0, 3), searched("b", 0, 1), searched("b", 1, 1)], tmp_path / "hard", None)
    assert [name[0] for name in names_in(tmp_path / "hard")] == ["a", "a", "b", "b"]


def test_a_pack_says_by_which_commands_it_was_found_and_what_each_gave(searched, tmp_path):
    join_packs([searched("a", 0, 3), searched("a", 2, 3)], tmp_path / "hard", 4)
    told = yaml.safe_load((tmp_path / "hard/searches.yaml").read_text())
    command = "arena break planner=a robot=jackal world=hall budget=48 count=12 seed={} tracker=legs"
    assert [one["command"] for one in told] == [command.format(seed) for seed in (0, 2)]
    assert [(one["code"], one["failures"], one["hard"], one["here"]) for one in told] == [
        ("abc", 9, 5, 3),
        ("abc", 9, 5, 1),
    ]
    assert "searches.yaml" in verified_pack(tmp_path / "hard").files


@pytest.mark.parametrize(
    ("second", "said"),
    [
        (("a", 0, 2), "holds a_jackal_00 again; allowed: searches of different seeds"),
        (("b", 0, 0), "found no hard problem; allowed: searches that found some"),
        (("b", 0, 2), "another map of that name"),
    ],
)
def test_what_cannot_be_joined_is_refused_in_one_line(second, said, searched, tmp_path):
    other = searched(*second, wide=61)
    with pytest.raises(ConfigurationError, match=said):
        join_packs([searched("a", 0, 2), other], tmp_path / "hard", 12)


def test_a_folder_that_is_there_is_left_alone(searched, tmp_path):
    (tmp_path / "hard").mkdir()
    with pytest.raises(ConfigurationError, match="allowed: a name that is free"):
        join_packs([searched("a", 0, 2)], tmp_path / "hard", None)
    assert not list((tmp_path / "hard").iterdir())
