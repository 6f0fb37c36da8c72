"""What a record holds only where it is asked for: tracks, and what the planner considered."""

import math

import numpy as np
import pytest

import arena_core as arena
from arena_core import Candidate, Planner, Tracks, Twist
from arena_core.hosting import InvalidCandidates
from arena_core.loop.extras import LONGEST, MOST, candidate_arrays, kept_candidates, track_arrays
from arena_core.loop.record_layout import fault_of
from arena_core.records import read_record
from arena_core.testing import samples


def way(cost, points=2, chosen=False):
    return Candidate(np.linspace((0.0, 0.0), (1.0, 0.0), points), cost, chosen)


def test_no_more_is_kept_than_fits_and_the_chosen_one_always():
    given = [way(float(k), 100) for k in range(100)] + [way(math.inf), way(50.5, 100, chosen=True)]
    kept = kept_candidates(given, "P")
    assert len(kept) == MOST
    assert kept[0].chosen
    assert max(len(one.points_xy) for one in kept) == LONGEST
    assert kept[0].points_xy[0].tolist() == [0.0, 0.0]
    assert kept[0].points_xy[-1].tolist() == [1.0, 0.0]
    assert kept[1].cost < 5.0
    assert math.isinf(kept[-1].cost)


def test_nothing_is_kept_of_a_planner_that_does_not_tell():
    assert kept_candidates(None, "P") == []
    assert Planner.considered(None) is None


@pytest.mark.parametrize(
    "wrong",
    ["x", Candidate(np.zeros(2), 0.0), Candidate(np.zeros((2, 3)), 0.0), Candidate(np.full((2, 2), np.nan), 0.0)],
)
def test_what_is_no_way_is_one_line(wrong):
    with pytest.raises(InvalidCandidates, match=r"P\.considered returned .*; allowed: "):
        kept_candidates([wrong], "P")


def test_arrays_are_ragged_and_rounded():
    arrays = candidate_arrays(
        [[way(1.0, chosen=True), Candidate(np.array(((0.001, 1 / 3),)), math.inf)], [], [way(2.0)]]
    )
    assert arrays["considered_rows"].tolist() == [0, 2, 2, 3]
    assert arrays["considered_offsets"].tolist() == [0, 2, 3, 5]
    assert arrays["considered_points"][2].tolist() == [0.0, round(128 / 3) / 128]
    assert arrays["considered_chosen"].tolist() == [True, False, False]
    assert candidate_arrays([])["considered_points"].shape == (0, 2)


def test_tracks_are_there_where_somebody_asked():
    seen = Tracks(np.array((4,), np.int32), np.ones((1, 2)), np.zeros((1, 2)), np.array((0.3,)), np.zeros((1, 4, 4)))
    arrays = track_arrays([None, seen, None])
    assert arrays["track_rows"].tolist() == [0, 0, 1, 1]
    assert arrays["track_ids"].tolist() == [4]
    assert track_arrays([])["track_rows"].tolist() == [0]


def damaged(name, change):
    record = samples.record()
    count = len(record["stamp"])
    arrays = dict(record.arrays) | candidate_arrays([[way(1.0)]] * (count - 1)) | track_arrays([None] * (count - 1))
    assert fault_of(arrays, record.meta) == ""
    changed = change(arrays[name])
    rest = {key: array for key, array in arrays.items() if key != name}
    return fault_of(rest if changed is None else {**rest, name: changed}, record.meta)


@pytest.mark.parametrize(
    ("name", "change", "fault"),
    [
        ("considered_costs", lambda array: None, "it lacks considered_costs"),
        ("considered_rows", lambda array: array + 1, "considered_rows are no offsets of considered_costs"),
        ("considered_offsets", lambda array: array[::-1], "considered_offsets are no offsets of considered_points"),
        ("considered_offsets", lambda array: array[[0, -1]], "considered_offsets are not those of considered_costs"),
        ("considered_points", lambda array: array[:, :1], "considered_points is float32"),
        ("track_rows", lambda array: array[:-1], "track_rows is int64"),
    ],
)
def test_damaged_extras_are_told(name, change, fault):
    assert damaged(name, change).startswith(fault)


class Teller(Planner):
    """Drives on and tells one way."""

    def compute_velocity(self, observation):
        self.seen = observation.tracks
        self.told = Candidate(np.array(((observation.pose.x, observation.pose.y), (0.0, 0.0))), 1.0, True)
        return Twist(0.2)

    def considered(self):
        return [self.told]


QUICK = [
    "planner=dwa",
    "robot=turtlebot3",
    "world=empty",
    "task.pedestrians=2",
    "episodes=1",
    "task.time_limit=3",
    "seed=2",
]
REST = ["executor=serial", "report=false", "localizer=ground_truth"]


@pytest.fixture
def teller(monkeypatch):
    monkeypatch.setattr("arena_dwa.planner.DwaPlanner.compute_velocity", Teller.compute_velocity)
    monkeypatch.setattr("arena_dwa.planner.DwaPlanner.considered", Teller.considered)


def record_of(folder, *words):
    arena.run([*QUICK, *REST, *words], folder)
    return read_record(folder / "records" / "0000.npz")


def test_records_are_the_same_but_for_what_was_asked_for(teller, tmp_path):
    bare = record_of(tmp_path / "bare")
    full = record_of(tmp_path / "full", "recording.tracks=true", "recording.considered=true")
    for name, array in bare.arrays.items():
        assert array.tobytes() == full[name].tobytes(), name
    assert {name.split("_")[0] for name in full.arrays.keys() - bare.arrays.keys()} == {"considered", "track"}
    assert bare.meta == full.meta
    assert full["considered_rows"].tolist() == list(range(len(bare["stamp"])))
    assert full["considered_points"][0] == pytest.approx(bare["estimate"][0][:2], abs=0.005)


def test_a_planner_is_not_asked_unless_the_run_records_it(teller, tmp_path, monkeypatch):
    def fail(self):
        raise AssertionError

    monkeypatch.setattr("arena_dwa.planner.DwaPlanner.considered", fail)
    assert record_of(tmp_path / "bare").meta["outcome"] == "time_out"
    asked = record_of(tmp_path / "asked", "recording.considered=true")
    assert asked.meta["outcome"] == "error"
    assert len(asked["considered_rows"]) == len(asked["stamp"])
