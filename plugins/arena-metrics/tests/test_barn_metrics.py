"""BARN's figures: the formula gives what the challenge recorded, and every edge of success is judged as there."""

from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import ConfigurationError
from arena_metrics.packs.barn import BarnMetrics, barn_score

BARN = Path(__file__).parents[3].parent / "shared" / "data" / "barn"
needs_barn = pytest.mark.skipif(
    not BARN.is_dir(), reason="the recorded runs of the BARN challenge are not at ../shared/data/barn"
)
PRESET = yaml.safe_load((files("arena_metrics.conf") / "metrics" / "barn.yaml").read_text())


def pack(**keys):
    return BarnMetrics(**{key: value for key, value in {**PRESET, **keys}.items() if key != "name"})


def figures(record):
    return {metric.name: metric.compute(record) for metric in pack().metrics()}


@pytest.fixture(scope="module")
def run(record_of, straight_line):
    """Make a run along x at 1 m/s towards a goal of radius 1 m, 9.5 m ahead, with an optimal time of 5 s."""

    def make(standing=0, length=8.6, **changes):
        poses = straight_line(length, 1.0)
        poses = np.concatenate((np.repeat(poses[:1], standing, axis=0), poses))
        scenario = {
            "start": [0, 0, 0],
            "goal": [9.5, 0, 0],
            "goal_radius": 0.3,
            "time_limit": 100.0,
            "reference_length": 10.0,
        }
        arrays = {key: value for key, value in changes.items() if key.startswith("contact")}
        scenario |= {key: value for key, value in changes.items() if key not in arrays}
        return record_of(poses, meta={"scenario": scenario}, **arrays)

    return make


@needs_barn
def test_formula_gives_the_recorded_success_and_score():
    runs = np.loadtxt(BARN / "dwa_out_worlds_0_144.txt")
    assert len(runs) == 250
    world, success, _, _, time, ratio = runs.T
    optimal = {}
    for w in np.unique(world).astype(int):  # the length of start, path and goal at 2 m/s, as run.py has it
        cells = np.load(BARN / "path_files" / f"path_{w}.npy")
        way = np.vstack(((-2.0, 3.0), cells * 0.15 + (-4.575, 5.075), (-2.0, 13.0)))
        optimal[w] = np.hypot(*np.diff(way, axis=0).T).sum() / 2.0
    of_run = np.array([optimal[int(w)] for w in world])
    arrived = success == 1
    assert np.abs(time[arrived] / of_run[arrived] - ratio[arrived]).max() < 0.01  # the file's own last column
    scores = [
        barn_score(t, o, PRESET["fastest"], PRESET["slowest"], success=bool(s))
        for s, t, o in zip(success, time, of_run, strict=True)
    ]
    assert success.mean() == pytest.approx(0.96)
    assert np.mean(scores) == pytest.approx(0.186, abs=5e-4)


@pytest.mark.parametrize(("later", "success"), [(0.0, 0.0), (0.05, 1.0)])
def test_a_contact_up_to_the_moment_of_arrival_is_a_failure(run, later, success):
    free = run()
    arrived = int(np.argmax(free["pose"][:, 0] >= 9.5 - PRESET["arrival"]))
    found = figures(run(contact_stamp=np.array((free["stamp"][arrived] + later,))))
    assert found["success"] == success


def test_run_at_half_the_reference_speed_scores_one_half(run):
    found = figures(run())
    assert found["success"] == 1.0
    assert found["optimal_time"] == 5.0
    assert found["time"] == pytest.approx(8.5 - 0.1)
    assert found["score"] == 0.5


def test_clock_begins_when_the_robot_has_moved(run):
    assert figures(run(standing=30))["time"] == pytest.approx(figures(run())["time"])


def test_slow_run_scores_its_share(run):
    assert figures(run(reference_length=4.2))["score"] == pytest.approx(2.1 / 8.4)
    assert figures(run(reference_length=1.0))["score"] == pytest.approx(1.0 / 8.0)


def test_straight_line_stands_in_for_a_missing_reference_path(run):
    assert figures(run(reference_length=None))["optimal_time"] == 9.5 / 2.0


@pytest.mark.parametrize(
    "failure", [{"length": 8.0}, {"time_limit": 5.0}, {"contact_stamp": [3.0]}, {"standing": 0, "length": 0.05}]
)
def test_failed_run_scores_nothing_and_has_no_time(run, failure):
    found = figures(run(**failure))
    assert (found["success"], found["score"]) == (0.0, 0.0)
    assert np.isnan(found["time"])


def test_contact_after_the_arrival_does_not_count(run):
    assert figures(run(contact_stamp=[8.55]))["success"] == 1.0


@settings(derandomize=True, deadline=None)
@given(time=st.floats(0.01, 1e3), optimal=st.floats(0.1, 100.0))
def test_score_of_an_arrival_lies_between_an_eighth_and_a_half(time, optimal):
    assert 1 / 8 - 1e-12 <= barn_score(time, optimal, 2.0, 8.0, success=True) <= 0.5 + 1e-12
    assert barn_score(2.0 * time, optimal, 2.0, 8.0, success=True) <= barn_score(time, optimal, 2.0, 8.0, success=True)
    assert barn_score(time, optimal, 2.0, 8.0, success=False) == 0.0


def test_bounds_in_the_wrong_order_are_refused():
    with pytest.raises(ConfigurationError, match=r"metrics\.barn\.fastest is 9"):
        pack(fastest=9.0)
