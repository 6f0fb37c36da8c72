"""Figures of walks are what they say, on walks made by hand and on simulated ones."""

import csv
from dataclasses import replace

import numpy as np
import pytest

from arena_core.cli.main import main
from arena_core.testing import component
from arena_crowds.validation.measure import rate_interval, ratio_interval
from arena_crowds.validation.measured_runs import Extent, benchmark_of, standing_episodes
from arena_crowds.validation.phases import Phased
from arena_crowds.validation.walk_record import WalkRecord, free_area, waypoint_spans


@pytest.fixture
def walked(stage):
    """Return a minute in which one person walks 6 m to and fro at 1 m/s past a robot, and
    another stands before a wall for 10 s.
    """
    hall = stage.hall(12, 6)
    people = [stage.person(0, (2, 3), (2, 3), (8, 3)), stage.person(1, (6, 0.5), (2, 0.5), (10, 0.5))]
    stamps = np.arange(0.0, 60.1, 0.1)
    to_and_fro = 2.0 + 6.0 - np.abs(stamps % 12.0 - 6.0)
    halting = 2.0 + np.clip(stamps, 0, 4) + np.clip(stamps - 14.0, 0.0, 4.0)
    positions = np.stack(
        [np.stack([to_and_fro, np.full_like(stamps, 3.0)], 1), np.stack([halting, np.full_like(stamps, 0.5)], 1)], 1
    )
    states = np.full(positions.shape[:2], 2, np.int8)
    states[stamps > 18.0, 1] = 1
    return WalkRecord(
        stage.scenario(hall, people), stamps, np.tile((5.0, 3.5, 0.0), (len(stamps), 1)), positions, states
    )


def test_spans_paces_and_stands_are_those_of_the_tracks(walked):
    assert walked.minutes == pytest.approx(1.0)
    assert walked.spans() == pytest.approx([6.0, 8.0])
    assert walked.paces() == pytest.approx([1.0, 8.0 / 18.0], abs=0.01)
    assert walked.standing() == pytest.approx(np.array([[0.0, 0.0], [10.0, 10.0]]), abs=1.2)


def test_every_time_that_somebody_comes_near_is_an_encounter(walked):
    assert walked.encounters() == 10
    away = replace(walked, poses=walked.poses + np.array((0.0, 1.5, 0.0)))
    assert away.encounters() == 0


def test_waypoints_span_and_floors_have_the_size_that_they_have(walked):
    assert waypoint_spans(walked.scenario) == pytest.approx([6.0, 8.0])
    assert free_area(walked.scenario.world.grid) == pytest.approx(11.9 * 5.9)


def test_intervals_hold_the_rate_and_equal_episodes_have_none(walked):
    assert rate_interval([walked] * 5) == (10.0, 10.0)
    assert ratio_interval([walked] * 5, [walked] * 3) == (1.0, 1.0)
    calm = replace(walked, poses=walked.poses + np.array((0.0, 9.0, 0.0)))
    low, high = rate_interval([walked, calm] * 5)
    assert low < 5.0 < high


def test_phases_are_places_on_the_round_and_differ(stage):
    hall = stage.hall(20, 20, stage.racks)
    scenario = stage.scenario(
        hall, [stage.person(0, (1.5, 1.5), (1.5, 1.5), (18.5, 18.5)), stage.person(1, (10.0, 10.0))]
    )

    class Same:
        def scenario(self, seed, index):
            return scenario

    drawn = [Phased(Same()).scenario(0, index) for index in range(5)]
    starts = np.array([each.pedestrians[0].position_xy for each in drawn])
    assert len(np.unique(starts.round(3), axis=0)) == 5
    assert not hall.occupied[tuple(hall.cells(starts).T)].any()
    assert all(np.array_equal(each.pedestrians[1].position_xy, (10.0, 10.0)) for each in drawn)
    again = Phased(Same()).scenario(0, 2)
    assert np.array_equal(again.pedestrians[0].position_xy, starts[2])


def test_a_measurement_writes_a_table_records_and_tracks(tmp_path, capsys):
    words = [
        "world=warehouse",
        "robot=jackal",
        "episodes=2",
        "seconds=6",
        "people=lifelike",
        "task.pedestrians=4",
        f"out={tmp_path}",
    ]
    assert main(["crowd", "measure", *words]) == 0
    assert "people_per_100_m2" in capsys.readouterr().out
    with (tmp_path / "measure.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["world"], row["robot"], row["driven_by"], row["people"]) == ("warehouse", "jackal", "stands", "4")
    assert float(row["track_span_m"]) > 2.0
    with np.load(tmp_path / "warehouse-jackal" / "records" / "0001.npz") as record:
        assert record["pedestrian_positions"].shape == (len(record["stamp"]), 4, 2)
        assert record["pose"].shape == (len(record["stamp"]), 3)
    assert (tmp_path / "warehouse-jackal" / "tracks.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["warehouse"], "arguments are warehouse; allowed: arena crowd measure"),
        (["minutes=0"], "minutes is 0; allowed: > 0"),
        (["world=ware"], "ware"),
    ],
)
def test_a_wrong_request_is_one_line(words, says, capsys):
    assert main(["crowd", "measure", *words]) == 2
    error = capsys.readouterr().err
    assert says in error
    assert len(error.strip().splitlines()) == 1


@pytest.mark.parametrize("model", ["social_force", "orca"])
@pytest.mark.parametrize("people", ["as_released", "lifelike"])
def test_problems_of_a_random_task_in_a_batch_equal_each_alone(model, people, stage):
    benchmark = benchmark_of([f"pedestrians={model}", f"people={people}", "task.pedestrians=6"], phased=False)
    scenarios = [benchmark.task.scenario(0, number) for number in range(3)]
    together = [crowd.positions for crowd in stage.walk(component("pedestrians", model), scenarios, 10.0)]
    for slot, scenario in enumerate(scenarios):
        alone = [crowd.positions[0] for crowd in stage.walk(component("pedestrians", model), [scenario], 10.0)]
        assert np.array_equal(np.array(alone), np.array([positions[slot] for positions in together]))


@pytest.mark.slow
def test_people_of_the_orca_crowd_get_round_the_walls_of_their_rounds_too():
    walks = standing_episodes(benchmark_of(["world=indoor", "pedestrians=orca"], phased=False), Extent(4, 60.0, 1.0))
    assert np.concatenate([each.spans() for each in walks]).mean() > 6.0
    assert np.concatenate([each.spans() for each in walks]).min() > 1.0
    assert np.concatenate([each.paces() for each in walks]).mean() > 0.85
