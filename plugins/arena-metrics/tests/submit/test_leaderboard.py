"""Only whole packs by the rules are ranked; those that cannot be told apart share their ranks."""

import json
import re
import shutil
from dataclasses import replace
from functools import reduce
from operator import getitem
from pathlib import Path

import pytest

import arena_submit.standing
from arena_core import ConfigurationError, InputFileError, Run
from arena_core.files import option_files
from arena_core.hosting import load_registry
from arena_core.records import read_record
from arena_reference.certifying import reference_runs
from arena_submit.commands import LeaderboardCommand, SubmitCommand
from arena_submit.leaderboard import leaderboard_page
from arena_submit.packing import read_pack, write_pack
from arena_submit.standing import benchmark_of, check_standing, read_standing


def test_the_first_version_has_every_scenario_of_the_pack_on_two_robots():
    found = read_standing("arena_v1")
    registry = load_registry()
    ours = {name for name in option_files("scenario", registry.manager) if name.startswith("arena/")}
    assert set(found.scenarios) == ours
    assert len(found.conditions) * found.episodes == 300


@pytest.mark.parametrize("scenario", ["arena/queue_high", "arena/outdoor_20"])
def test_the_hashes_are_those_of_the_scenarios_that_are_driven(scenario):
    from arena_core.hosting import compose, to_plain

    registry = load_registry()
    config = to_plain(compose(["experiment=arena_v1", "robot=jackal", f"scenario={scenario}"]))
    robot = registry.build("robot", config["robot"])
    task = registry.build("task", config["task"], robot=robot, world=registry.build("world", config["world"]))
    assert task.scenario(0, 0).content_hash == read_standing("arena_v1").scenarios[scenario]


def test_a_pack_of_no_standing_benchmark_is_not_ranked(packed, capsys):
    with read_pack(packed) as pack:
        assert benchmark_of(pack) is None
    with pytest.raises(InputFileError, match=r"pack\.zip: is of no standing benchmark"):
        LeaderboardCommand().run([str(packed)])


def test_a_pack_that_is_refused_leaves_no_file_and_is_called_as_it_was_to_be(faced, small, tmp_path, monkeypatch):
    run = Path(shutil.copytree(faced().parent / "run", tmp_path / "run"))
    facts = json.loads((run / "provenance.json").read_text())
    facts["config"]["task"]["time_limit"] = 20
    (run / "provenance.json").write_text(json.dumps(facts))
    monkeypatch.chdir(tmp_path)
    Path("kept.zip").write_bytes(b"of before")
    for target in ("mine.zip", "kept.zip", "new/mine.zip"):
        with pytest.raises(InputFileError, match=f"^{target}: .* has task.time_limit 20, not "):
            SubmitCommand().run(["run", f"out={target}"])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["kept.zip", "run"]
    assert Path("kept.zip").read_bytes() == b"of before"


def test_a_part_of_the_benchmark_is_not_ranked(faced):
    with (
        read_pack(faced()) as pack,
        pytest.raises(InputFileError, match="lacks 59 of 60 conditions, turtlebot3 arena/blind_corner_high among"),
    ):
        check_standing(pack, benchmark_of(pack), load_registry())


@pytest.mark.parametrize(
    ("key", "value", "fault"),
    [
        ("localizer.name", "ground_truth", 'has localizer.name "ground_truth", not "amcl"'),
        ("pedestrians.reaction", "yield", 'has pedestrians.reaction "yield", not "ignore"'),
        ("task.time_limit", 20, "has task.time_limit 20, not "),
        ("world.path", "own.yaml", 'has world.path "own.yaml", not "pkg://arena_scenarios'),
        ("seed", 1, "has seed 1 and 5 episodes, not 0 and 5"),
    ],
)
def test_other_rules_are_named(key, value, fault, faced, small, tmp_path):
    def change(config):
        *place, name = key.split(".")
        reduce(getitem, place, config)[name] = value

    assert fault in refusal(faced(), change, small, tmp_path)


def refusal(pack, change, wanted, place):
    """Return why a pack is not ranked, the configuration of whose run is changed."""
    run = Path(shutil.copytree(pack.parent / "run", place / "run"))
    facts = json.loads((run / "provenance.json").read_text())
    change(facts["config"])
    (run / "provenance.json").write_text(json.dumps(facts))
    write_pack([run], place / "pack.zip")
    with read_pack(place / "pack.zip") as changed, pytest.raises(InputFileError) as error:
        check_standing(changed, wanted, load_registry())
    return str(error.value)


def of_before(config):
    """Make a configuration that of an earlier version: another default, a key that was not there yet, one
    that is not there any more.
    """
    config["global_planner"]["padding"] = 0.0
    del config["recoveries"]["progress_time"]
    config["localizer"]["gone"] = [1, 2]


def test_a_pack_of_before_a_default_was_changed_is_named_with_all_that_differs(faced, small, tmp_path):
    line = refusal(faced(), of_before, small, tmp_path)
    assert (
        "runs/0 (jackal arena/warehouse_05) has global_planner.padding 0.0, not null, "
        "lacks recoveries.progress_time, which is " in line
    )
    assert (
        "has localizer.gone [1, 2], which the experiment has not; allowed: runs of experiment=arena_v1 as it is here"
        in line
    )
    assert "\n" not in line


def test_many_differences_are_counted(faced, small, tmp_path):
    line = refusal(faced(), lambda config: config["localizer"].clear(), small, tmp_path)
    assert line.count("lacks localizer.") == 3
    assert "more differ; allowed" in line


def test_commands_refuse_a_pack_of_before_beside_one_of_now(faced, small, tmp_path):
    refusal(faced(), of_before, small, tmp_path)
    together, alone = [faced(), tmp_path / "pack.zip"], [tmp_path / "run", f"--to={tmp_path / 'a.zip'}"]
    for command, words in ((LeaderboardCommand(), together), (SubmitCommand(), alone)):
        with pytest.raises(InputFileError, match=r"has global_planner\.padding 0\.0, not null"):
            command.run([str(word) for word in words])


def test_planners_are_ranked_with_their_cards(faced, small, tmp_path):
    packs = [faced(), faced("planner.speed=0.4")]
    assert LeaderboardCommand().run([*map(str, packs), "--to", str(tmp_path / "board.md")]) == 0
    text = (tmp_path / "board.md").read_text()
    ranked = [line.split(" | ") for line in text.splitlines() if line.startswith(("| 1", "| 2"))]
    assert [row[0] for row in ranked] == ["| 1–2", "| 1–2"], "five episodes cannot tell them apart"
    assert [row[1] for row in ranked] == ["pure_pursuit", "pure_pursuit"]
    assert ranked[0][4] == "–"
    assert re.fullmatch(r"−?\d+ \(−?\d+ to \d+\)", ranked[1][4])
    assert [row[10:12] for row in ranked] == [["by hand, no card, 0 episodes", "–"]] * 2
    assert text.count("## pure_pursuit (") == 2
    assert "| jackal | 5 |" in text
    assert "| warehouse | 5 |" in text


def test_each_table_has_ranks_of_its_own(faced, small, monkeypatch):
    tables = {"arena/ware": "Halls", "arena/": "All of them"}
    monkeypatch.setattr(
        arena_submit.standing, "read_standing", lambda name: replace(small, tables=tables, strict=["arena/"])
    )
    with read_pack(faced()) as pack:
        lines = leaderboard_page([pack], load_registry()).splitlines()
    titles = [line.removeprefix("## ") for line in lines if line.startswith("## ")]
    assert titles == ["Halls", "All of them", f"pure_pursuit ({pack.digest[:12]})"]
    assert sum(line.startswith("| 1 | pure_pursuit |") for line in lines) == 2
    assert [line.split(" | ")[2:6:3] for line in lines if line.startswith("| rank")] == [
        ["success", "no collision"],
        ["no collision", "success"],
    ], "where contacts count, the share without any is ranked"
    assert "- `arena_v1`: 1 scenario of 5 episodes with jackal" in lines
    assert "p after Holm among all pairs of a table: a rank" in "\n".join(lines)


@pytest.mark.slow
def test_certificates_beside_a_run_are_the_last_line_which_has_no_rank(faced, small, tmp_path):
    run, board = Path(shutil.copytree(faced().parent / "run", tmp_path / "run")), tmp_path / "board.md"
    words = [str(faced()), f"reference={run}", f"out={board}"]
    with pytest.raises(InputFileError, match="run: holds no certificates; allowed: finished runs with what `arena ref"):
        LeaderboardCommand().run(words)
    reference_runs([Run(run)], {"name": "serial"}, load_registry())
    assert LeaderboardCommand().run(words) == 0
    text = board.read_text()
    (ranked, certified) = [line.split(" | ") for line in text.splitlines() if line.startswith(("| 1 |", "| – |"))]
    assert ranked[:2] == ["| 1", "pure_pursuit"]
    assert certified[:3] == ["| –", "clairvoyant (no competitor)", "100 %"]
    assert "in the 5 of 5 problems for which" in text
    assert "## clairvoyant (no competitor)\n" in text


def test_a_reference_of_another_benchmark_is_refused(faced, finished, small):
    with pytest.raises(InputFileError, match="run: is no condition of it; allowed: runs of experiment=arena_v1 as it"):
        LeaderboardCommand().run([str(faced()), f"reference={finished}"])


def test_a_pack_given_twice_is_refused(faced, small):
    with read_pack(faced()) as pack, pytest.raises(InputFileError, match="a pack is given twice"):
        leaderboard_page([pack, pack], load_registry())


def test_submitting_the_whole_benchmark_prints_its_card(faced, small, tmp_path, capsys):
    assert SubmitCommand().run([str(faced().parent / "run"), "--to", str(tmp_path / "whole.zip")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:2] == ["pure_pursuit", "episodes"]
    assert [line.split()[0] for line in lines[1:4]] == ["all", "jackal", "warehouse"]
    assert lines[4].endswith("whole.zip: 5 episodes, all of experiment=arena_v1")


@pytest.mark.parametrize("words", [["--to", "pack.zip"], ["run", "--to", "pack.tar"], ["run"]])
def test_a_wrong_request_is_one_line(words):
    with pytest.raises(ConfigurationError, match="allowed: arena submit RUN"):
        SubmitCommand().run(words)


def test_packs_of_several_planners_are_refused(faced, small, tmp_path):
    other = faced().parent / "run"
    record = read_record(other / "records" / "0000.npz")
    assert record.meta["columns"]["scenario_hash"] == small.scenarios["arena/warehouse_05"]
    write_pack([other, faced("planner.speed=0.4").parent / "run"], tmp_path / "two.zip")
    with read_pack(tmp_path / "two.zip") as pack, pytest.raises(InputFileError, match="is there twice"):
        check_standing(pack, small, load_registry())
