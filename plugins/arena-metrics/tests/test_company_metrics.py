"""How well a robot kept with its person: closed forms on drives along a line."""

from importlib.resources import files

import numpy as np
import pytest
import yaml

from arena_metrics.packs.company import CompanyMetrics

PRESET = yaml.safe_load((files("arena_metrics.conf") / "metrics" / "company.yaml").read_text())
TOGETHER = {"nearest": 1.0, "farthest": 2.0, "person": 4}


@pytest.fixture(scope="module")
def figures(record_of, straight_line):
    """Return the figures of a robot at 1 m/s along x for 10 s, and of a person at ``offset(x)`` from it."""

    def compute(offset, manner="follow", person=4):
        poses = straight_line(10.0, 1.0)
        places = poses[:, None, :2] + np.array([offset(x) for x in poses[:, 0]])[:, None]
        velocities = np.gradient(places, poses[1, 0] - poses[0, 0], axis=0)
        record = record_of(
            poses,
            meta={"scenario": {"company": {**TOGETHER, "manner": manner}}},
            pedestrian_ids=np.array((person,), np.int32),
            pedestrian_positions=places,
            pedestrian_velocities=velocities,
        )
        pack = CompanyMetrics(**{key: value for key, value in PRESET.items() if key != "name"})
        return {metric.name: metric.compute(record) for metric in pack.metrics()}

    return compute


def test_a_person_one_and_a_half_metres_ahead_all_the_time_is_kept(figures):
    found = figures(lambda x: (1.5, 0.0))
    assert found["kept"] == pytest.approx(1.0)
    assert found["distance"] == pytest.approx(1.5)
    assert (found["apart"], found["too_near"]) == (0.0, 0.0)
    assert np.isnan(found["beside"])


def test_a_person_who_gets_away_half_way_is_apart_for_the_rest(figures):
    found = figures(lambda x: (1.5 if x <= 5.0 else 3.0, 0.0))
    assert found["kept"] == pytest.approx(0.5, abs=0.02)
    assert found["apart"] == pytest.approx(4.9, abs=0.11)
    assert found["too_near"] == 0.0


def test_a_robot_that_pushes_is_too_near(figures):
    found = figures(lambda x: (0.5, 0.0))
    assert (found["kept"], found["too_near"]) == (0.0, pytest.approx(10.0))


def test_who_walks_abreast_has_the_robot_at_its_side_and_who_walks_ahead_has_not(figures):
    assert figures(lambda x: (0.0, 1.2), "accompany")["beside"] == 1.0
    assert figures(lambda x: (1.2, 0.0), "accompany")["beside"] == 0.0
    assert figures(lambda x: (0.8, 0.9), "accompany")["beside"] == 1.0  # 42 degrees ahead of it


def test_without_its_person_nothing_is_said(figures):
    assert all(np.isnan(value) for value in figures(lambda x: (1.5, 0.0), person=5).values())
