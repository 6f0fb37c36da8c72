"""The second version of the standing benchmark: crowds, situations, hard problems, and a field of cylinders."""

import math
from dataclasses import replace

import pytest

from arena_core.files import option_files
from arena_core.hosting import compose, load_registry, to_plain
from arena_metrics.pooling.cells import Cell
from arena_metrics.pooling.runs import Episode, Run
from arena_submit.breaking import breaking_lines
from arena_submit.cards import ScoreCard
from arena_submit.packing import PackedRun, read_pack, write_pack
from arena_submit.standing import benchmark_of, read_standing, run_fault

V2 = read_standing("arena_v2")


def part(experiment):
    return next(one for one in V2.parts if one.experiment == experiment)


def test_its_parts_are_crowds_on_three_robots_all_cards_the_hard_problems_and_the_field():
    registry = load_registry()
    cards = {name for name in option_files("scenario", registry.manager) if name.startswith("francis2023/")}
    assert set(part("francis2023").scenarios) == cards
    assert [len(one.conditions) * one.episodes for one in V2.parts] == [504, 1125, 66, 30]
    assert V2.problems == 1725


def test_every_condition_is_in_one_table():
    for _, scenario in V2.all_conditions:
        assert sum(scenario.startswith(start) for start in V2.tables) == 1


@pytest.mark.parametrize("condition", [("francis2023", "francis2023/narrow_doorway_high"), ("hard_v1", "hard_v1")])
def test_the_hashes_are_those_of_what_is_driven(condition):
    experiment, scenario = condition
    words = [f"experiment={experiment}", *([f"scenario={scenario}"] if scenario != experiment else [])]
    registry, config = load_registry(), to_plain(compose([*words, "robot=jackal"]))
    robot = registry.build("robot", config["robot"])
    task = registry.build("task", config["task"], robot=robot, world=registry.build("world", config["world"]))
    assert task.scenario(0, 0).content_hash == part(experiment).scenarios[scenario]


@pytest.mark.parametrize(
    ("scenario", "words"),
    [
        ("hall_slow_16", ["world=outdoor", "task.density=16"]),
        ("rooms_walking_04", ["world=rooms", "task.density=4", "task.random.people.speed=1.34"]),
    ],
)
def test_a_crowd_is_a_rung_of_the_ladder(scenario, words):
    ours = to_plain(compose(["experiment=arena_v2", "robot=jackal", f"scenario=arena_v2/{scenario}"]))
    ladder = to_plain(compose(["experiment=ladder", "robot=jackal", *words]))
    for kind in ("robot", "world", "task", "pedestrians", "simulator", "localizer", "tracker"):
        assert ours[kind] == ladder[kind]


def test_a_run_of_the_field_has_to_be_as_its_experiment_says():
    registry, config = load_registry(), to_plain(compose(["experiment=dynabarn"]))
    config["choices"] = {"experiment": "dynabarn", "robot": "jackal"}
    rows = [{"episode": str(k)} for k in range(30)]
    run = PackedRun("runs/0", rows, {"config": config}, ())
    assert run_fault(run, V2, registry) == ""
    changed = replace(run, provenance={"config": {**config, "stop_on_collision": False}})
    assert run_fault(changed, V2, registry) == "has stop_on_collision false, not true"
    moved = replace(run, provenance={"config": {**config, "choices": {**config["choices"], "robot": "robotino"}}})
    assert run_fault(moved, V2, registry) == "is no condition of it"


def test_a_part_alone_is_of_no_standing_benchmark(finished, tmp_path, monkeypatch):
    write_pack([finished], tmp_path / "pack.zip")
    with read_pack(tmp_path / "pack.zip") as pack:
        (run,) = pack.runs
        for experiments, found in [(["dynabarn"], None), (["arena_v2", "dynabarn"], V2), (["arena_v2", "demo"], None)]:
            choices = [{"config": {**run.config, "choices": {"experiment": name}}} for name in experiments]
            assert benchmark_of(replace(pack, runs=[replace(run, provenance=one) for one in choices])) == found


def drawn_cell(scenario, density, outcomes, robot="jackal"):
    """Return a cell of an arena_v2 scenario, whose episodes ended so."""
    config = {
        "choices": {"robot": robot, "scenario": f"arena_v2/{scenario}", "experiment": "arena_v2"},
        "task": {"name": "density", "density": density},
    }
    kind, run = scenario.partition("_")[0], Run(None, [], {"config": config})
    rows = [
        {
            **{"world": kind, "task": "density", "scenario": f"density/{k:04d}", "scenario_hash": ""},
            **{"seed": 7200000, "episode": k, "success": won, "strict_success": won},
        }
        for k, won in enumerate(outcomes)
    ]
    return Cell("", "", [Episode(row, run) for row in rows], config, {"planner": "teb", "robot": robot})


def test_the_same_map_with_other_people_is_the_same_problem():
    outcomes = [1.0] * 6 + [0.0] * 6
    cells = [drawn_cell(f"hall_slow_{n:02d}", n, outcomes) for n in (4, 8, 16)]
    whole, single = ScoreCard("teb", "", "", cells).success(), ScoreCard("teb", "", "", cells[:1]).success()
    assert (whole.n, whole.problems) == (36, 12)
    assert whole.mean == single.mean == 0.5
    assert whole.high - whole.low == pytest.approx(single.high - single.low, rel=0.15), (
        "three times the same tells nothing"
    )


def test_situations_of_a_card_are_crowds_and_experiments():
    cells = [
        drawn_cell("hall_00", 0, [1.0]),
        drawn_cell("hall_slow_04", 4, [1.0]),
        drawn_cell("hall_slow_08", 8, [0.0]),
    ]
    hard = replace(cells[0], config={"choices": {"robot": "jackal", "experiment": "hard_v1"}, "task": {}})
    card = ScoreCard("teb", "", "", [*cells, hard])
    assert {name: len(found) for name, found in card.parts("situation").items()} == {
        "hall": 1,
        "hall_slow": 2,
        "hard_v1": 1,
    }
    assert [len(card.only(start).cells) for start in V2.tables] == [3, 0, 1, 0]


def test_problems_searched_against_a_planner_itself_are_left_out_of_its_card():
    config = {"choices": {"robot": "jackal", "experiment": "hard_v1"}, "task": {"name": "scenario"}}
    names = ["teb_jackal_01", "teb_jackal_11", "mppi_jackal_01", "teb_robotino_01"]
    rows = [{"preset": "teb", "robot": "jackal", "scenario": f"{name}/0000", "success": 1.0} for name in names]
    cell = Cell(
        "", "", [Episode(row, Run(None, [], {})) for row in rows], config, {"planner": "teb", "robot": "jackal"}
    )
    kept = ScoreCard("teb", "", "", [cell]).without_own(["hard_v1"])
    assert [episode.row["scenario"] for episode in kept.cells[0].episodes] == [f"{name}/0000" for name in names[2:]]
    assert ScoreCard("teb", "", "", [cell]).without_own([]).cells == [cell]


def test_where_planners_break_is_told_by_robot_and_crowd():
    robust = [drawn_cell("hall_00", 0, [1.0] * 12)]
    robust += [drawn_cell(f"hall_{crowd}_{n:02d}", n, [1.0] * 12) for crowd in ("slow", "walking") for n in (4, 8, 16)]
    weak = [drawn_cell("hall_00", 0, [1.0] * 12)]
    weak += [drawn_cell(f"hall_slow_{n:02d}", n, [1.0] * k + [0.0] * (12 - k)) for n, k in ((4, 12), (8, 6), (16, 0))]
    lines = breaking_lines([ScoreCard("strong", "", "", robust), ScoreCard("weak", "", "", weak)])
    head, _, strong, other = lines[-4:]
    assert head == "| planner | robot | hall_slow | hall_walking |"
    assert strong.startswith("| strong | jackal | above 16")
    texts = other.strip("| ").split(" | ")
    assert texts[:2] == ["weak", "jackal"]
    assert 4.0 < float(texts[2].split()[0]) < 8.0
    assert texts[3] == "–"


def test_without_crowds_nothing_is_said_of_breaking():
    assert breaking_lines([ScoreCard("teb", "", "", [drawn_cell("hall_00", 0, [math.nan])])]) == []
