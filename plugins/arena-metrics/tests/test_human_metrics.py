"""A robot beside the person whose place it took: closed forms on a line."""

from importlib.resources import files

import numpy as np
import pytest
import yaml

from arena_metrics.packs.human import HumanMetrics

PRESET = yaml.safe_load((files("arena_metrics.conf") / "metrics" / "human.yaml").read_text())


@pytest.fixture(scope="module")
def figures(record_of, straight_line):
    """Return the figures of a robot at 1 m/s along x for 10 m, and of a person at ``speed`` and ``y`` on the same way;
    ``other`` is where another one stands.
    """

    def compute(speed, y=0.0, other=(50.0, 50.0), **meta):
        poses = straight_line(10.0, 1.0)
        stamps = np.linspace(0.0, 10.0 / speed, 41)
        places = np.stack((speed * stamps, np.full(41, y)), axis=1)
        walk = {"person": 3, "begin": 0.0, "stamps": stamps.tolist(), "positions": places.tolist()}
        record = record_of(
            poses,
            meta={"scenario": {"replaces": walk}, **meta},
            pedestrian_ids=np.array((1,), np.int32),
            pedestrian_positions=np.tile(np.array(other), (len(poses), 1, 1)),
        )
        pack = HumanMetrics(near=PRESET["near"])
        return {metric.name: metric.compute(record) for metric in pack.metrics()}

    return compute


def test_a_robot_that_does_as_the_person_did_differs_in_nothing(figures):
    assert figures(1.0) == pytest.approx(
        dict.fromkeys(("ade", "fde", "extra_time", "extra_path", "extra_intrusion"), 0.0)
    )


def test_a_robot_abreast_is_off_by_its_distance(figures):
    found = figures(1.0, y=0.7)
    assert (found["ade"], found["fde"]) == pytest.approx((0.7, 0.7))


def test_a_slower_robot_falls_behind_and_comes_later(figures):
    found = figures(2.0)
    assert found["ade"] == pytest.approx(2.5)  # from 0 to 5 m in five seconds
    assert found["fde"] == pytest.approx(5.0)
    assert found["extra_time"] == pytest.approx(5.0)
    assert found["extra_path"] == pytest.approx(0.0)


def test_intrusion_is_that_of_the_robot_less_that_of_the_person(figures):
    passing = figures(2.0, other=(5.0, 0.0))["extra_intrusion"]
    alone = 1.2**2  # the integral of 1.2 - |x| over the way at 1 m/s, half of it at 2 m/s
    assert passing == pytest.approx(alone - 0.5 * alone, abs=0.02)


def test_a_robot_that_has_not_arrived_has_no_time(figures):
    assert np.isnan(figures(1.0, outcome="time_out")["extra_time"])


def test_other_tasks_have_no_figures(record_of, straight_line):
    record = record_of(straight_line(3.0, 1.0))
    assert all(np.isnan(metric.compute(record)) for metric in HumanMetrics(near=1.2).metrics())
