"""What a robot costs people, on scenes whose figures can be worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import EpisodeRecord, OccupancyGrid, Pose, World
from arena_core.hosting import build_benchmark, compose, load_registry
from arena_core.testing import scenario
from arena_core.testing.samples import person, room
from arena_reference.people_cost import COLUMNS, cost_row, empty_row, free_row
from arena_reference.redriving import Driven, RecordDiffers, redrive
from arena_reference.twins import PLACEBO, RECORDED, WITHOUT, drive_twins

WORDS = ("robot=turtlebot3", "planner=dwa", "world=empty", "metrics=[si]")


@pytest.fixture(scope="module")
def benchmark_of():
    """Give a function that builds a benchmark of people with a reaction."""
    built = {}

    def _benchmark_of(reaction):
        if reaction not in built:
            built[reaction] = build_benchmark(compose([*WORDS, f"pedestrians.reaction={reaction}"]), load_registry())
        return built[reaction]

    return _benchmark_of


def drive(benchmark, problem, commands):
    """Return the record of a drive by these commands (T - 1, 3)."""
    commands = np.asarray(commands, float)
    stamp = benchmark.navigator.control_period * np.arange(len(commands) + 1)
    snapshot = benchmark.simulator.reset([problem])
    poses, people = [snapshot.poses[0]], [snapshot.crowd.positions[0]]
    for command in commands:
        snapshot = benchmark.simulator.advance(command[None], round(benchmark.navigator.control_period / 0.01))
        poses.append(snapshot.poses[0])
        people.append(snapshot.crowd.positions[0])
    last = np.full((1, 3), np.nan)
    arrays = {
        "stamp": stamp,
        "pose": np.array(poses),
        "command": np.vstack((commands, last)),
        "pedestrian_positions": np.array(people, np.float32),
    }
    return EpisodeRecord(arrays, {"scenario": {"name": problem.name}})


def cost(benchmark, problem, commands):
    record = drive(benchmark, problem, commands)
    twins = drive_twins(benchmark, record, problem)
    return cost_row(record, twins), twins


def ahead(speed, seconds):
    return np.tile((speed, 0.0, 0.0), (round(10 * seconds), 1))


def corridor():
    """Return the walled room with a corridor of 0.8 m along x."""
    grid = room()
    data = grid.data.copy()
    rows = np.abs((np.arange(data.shape[0]) + 0.5) * grid.resolution + grid.origin.y)
    data[(rows > 0.4) & (rows < 1.0)] = 100
    return World("corridor", OccupancyGrid(data, grid.resolution, grid.origin))


def test_people_who_ignore_a_robot_that_touches_none_are_delayed_by_exactly_nothing(benchmark_of):
    people = [person(1, -3.0, 1.5, (3.0, 1.5), (-3.0, 1.5)), person(2, 3.0, 2.5, (-3.0, 2.5), (3.0, 2.5))]
    row, twins = cost(benchmark_of("ignore"), scenario(Pose(-2.0, -2.0), people=people), ahead(0.2, 8))
    assert np.array_equal(twins.positions[:, RECORDED], twins.positions[:, WITHOUT])
    assert {row[column.name] for column in COLUMNS[:12]} == {0.0}
    assert (row["people_compared"], row["people_censored"], row["people_left_out"]) == (2.0, 0.0, 0.0)


@pytest.mark.parametrize("mode", ["trigger_zone", "signal_wait", "signal_proceed"])
def test_who_starts_when_the_robot_comes_starts_then_without_it(benchmark_of, mode):
    waits = {"start_up_mode": mode, "trigger_zone_radius": 2.0}
    waiting = replace(person(1, 0.0, 1.5, (3.0, 1.5), (-3.0, 1.5)), behaviour=waits)
    never = replace(person(2, 3.0, -3.0, (-3.0, -3.0)), behaviour={**waits, "trigger_zone_radius": 0.5})
    row, twins = cost(benchmark_of("ignore"), scenario(Pose(-2.5, 0.0), people=[waiting, never]), ahead(0.2, 10))
    begins = np.flatnonzero((twins.positions[:, WITHOUT, 0] != twins.positions[0, WITHOUT, 0]).any(axis=1))[0]
    assert 2.0 < twins.stamps[begins] < 9.0
    assert np.array_equal(twins.positions[:, RECORDED], twins.positions[:, WITHOUT])
    assert row["people_delay"] == row["people_displacement"] == 0.0


def test_a_walker_held_up_in_a_corridor_is_late_by_the_time_it_waited(benchmark_of):
    """The robot stands for 12 s where nobody can pass; the walker goes on once it is gone."""
    problem = replace(scenario(Pose(0.5, 0.0), people=[person(1, -3.0, 0.0, (3.0, 0.0))]), world=corridor())
    row, twins = cost(benchmark_of("yield"), problem, ahead(0.0, 12))
    waits = twins.positions[twins.rows - 1, RECORDED, 0, 0]
    there = np.searchsorted(twins.positions[:, WITHOUT, 0, 0], waits)
    waited = twins.end - twins.stamps[there]
    assert waits < 0.0
    assert waited < row["people_delay"] < waited + 1.0  # it has to come to its speed again
    assert row["people_delay"] == row["people_delay_worst"]
    assert 0.0 <= row["people_detour"] < 1.0  # it steps to and fro before the robot
    assert row["people_stops"] >= 1.0
    gone = twins.positions[: twins.rows, WITHOUT, 0] - twins.positions[: twins.rows, RECORDED, 0]
    assert row["people_displacement"] == pytest.approx(np.linalg.norm(gone, axis=1).mean())
    expected = twins.end + twins.visits.stamps[0, RECORDED, 0]
    assert row["aggregated_time"] == pytest.approx(expected)


def test_a_walker_goes_round_a_standing_robot_and_little_more(benchmark_of):
    problem = scenario(Pose(0.0, 0.0), people=[person(1, -3.0, 0.05, (3.0, 0.05), speed=1.0)])
    row, twins = cost(benchmark_of("yield"), problem, ahead(0.0, 4))
    aside = np.abs(twins.positions[:, RECORDED, 0, 1] - 0.05).max()
    assert 0.2 < aside < 1.0
    assert 0.0 < row["people_detour"] < 2.0 * aside  # two sides of a triangle are no longer than its base and height
    assert 0.0 < row["people_delay"] < 3.0


def test_nothing_below_the_noise_is_a_cost(benchmark_of):
    problem = scenario(Pose(0.0, 0.0), people=[person(1, -3.0, 0.05, (3.0, 0.05), speed=1.0)])
    record = drive(benchmark_of("yield"), problem, ahead(0.0, 4))
    twins = drive_twins(benchmark_of("yield"), record, problem)
    noisy = twins.positions.copy()
    noisy[:, PLACEBO] = noisy[:, WITHOUT] + (5.0, 0.0)
    found = cost_row(record, replace(twins, positions=noisy))
    assert (
        found["people_displacement"] == found["people_displacement_worst"] == found["people_displacement_floor"] == 0.0
    )


def test_who_does_not_arrive_is_censored(benchmark_of):
    """The walker needs a hundred seconds, with the robot and without."""
    slow, quick = person(1, -3.0, 2.0, (3.0, 2.0), speed=0.05), person(2, -3.0, 0.0, (3.0, 0.0))
    row, _ = cost(benchmark_of("ignore"), scenario(Pose(0.0, -2.0), people=[slow, quick]), ahead(0.0, 3))
    assert (row["people_compared"], row["people_censored"]) == (1.0, 0.0)
    assert row["people_delay"] == 0.0


def test_a_record_of_another_drive_is_refused(benchmark_of):
    benchmark, problem = benchmark_of("ignore"), scenario(Pose(0.0, -2.0))
    record = drive(benchmark, problem, ahead(0.2, 1))
    off = {**record.arrays, "command": np.nan_to_num(record["command"]) * 0.5}
    driven = Driven(benchmark.simulator, benchmark.simulator.reset([problem]))
    with pytest.raises(RecordDiffers, match="does not come out as recorded"):
        list(redrive(benchmark, EpisodeRecord(off, record.meta), driven))


def test_nothing_known_and_nothing_to_know_are_told_apart():
    record = EpisodeRecord({"pedestrian_positions": np.zeros((3, 2, 2))}, {})
    assert empty_row("no people")["note"] == "no people"
    assert np.isnan(empty_row("no people")["people_delay"])
    assert free_row(record, "as recorded")["people_delay"] == 0.0
    assert free_row(record, "as recorded")["people_compared"] == 2.0
    assert set(empty_row("")) == set(free_row(record, "")) == {column.name for column in COLUMNS}
