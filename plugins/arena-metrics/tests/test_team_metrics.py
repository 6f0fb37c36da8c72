"""How a team fared: closed forms on tracks that are written down."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core.testing import component
from arena_metrics.packs.team import TeamMetrics

FAST = {"vx_max": 0.5, "vx_min": -0.5}


def figures(record_of, track, outcomes=(), ends=(), member=0, types=(), **more):
    """Return the figures of a robot from where its team was, (S, M, 2), every 0.1 s."""
    track = np.asarray(track, float)
    poses = np.concatenate((track, np.zeros((*track.shape[:2], 1))), axis=2)
    stamps, count = 0.1 * np.arange(len(track)), track.shape[1]
    robots = [
        {
            "name": f"robot{k}",
            "planner": "dwa",
            "start": poses[0, k].tolist(),
            "goal": poses[-1, k].tolist(),
            "outcome": (outcomes or ["goal_reached"] * count)[k],
            "end": float((ends or [stamps[-1]] * count)[k]),
            **({"robot": types[k]} if types else {}),
        }
        for k in range(count)
    ]
    disc = {"radius": 0.2, "vertices_xy": []}
    limits = {"robot": {"limits": FAST, "footprint": disc, **more.pop("robot", {})}}
    record = record_of(
        poses[:, member],
        meta={"team": {"member": member, "robots": robots}, **limits},
        **more,
    )
    record = replace(record, arrays={**record.arrays, "team_stamp": stamps, "team_pose": poses})
    pack: TeamMetrics = component("metrics", "team", [])
    return {metric.name: metric.compute(record) for metric in pack.metrics()}


def lines(*ends, seconds=20.0):
    """Return a track on which each robot goes from its first place to its second one, evenly."""
    shares = np.linspace(0.0, 1.0, round(10 * seconds) + 1)[:, None]
    return np.stack([(1 - shares) * np.array(a) + shares * np.array(b) for a, b in ends], axis=1)


def test_times_of_a_team_whose_robots_arrive_one_after_another(record_of):
    track = lines(((0, 0), (5, 0)), ((0, 3), (2, 3)), ((0, 6), (4, 6)))
    found = figures(record_of, track, ends=(20.0, 10.0, 14.0))
    assert found["all_succeed"] == 1.0
    assert found["makespan"] == 20.0
    assert found["sum_of_times"] == 44.0
    assert found["delay"] == pytest.approx(20.0 - 5.0 / 0.5)
    assert found["fairness"] == pytest.approx(np.std([10.0, 6.0, 6.0]))


def test_a_team_of_which_one_does_not_arrive_has_no_makespan(record_of):
    track = lines(((0, 0), (5, 0)), ((0, 3), (5, 3)), ((0, 6), (5, 6)))
    found = figures(record_of, track, ("goal_reached", "time_out", "goal_reached"), (14.0, 20.0, 20.0), member=1)
    assert found["all_succeed"] == 0.0
    assert np.isnan(found["makespan"])
    assert np.isnan(found["sum_of_times"])
    assert np.isnan(found["delay"])
    assert found["fairness"] == pytest.approx(3.0)  # of delays 4 and 10 s


def test_least_gap_between_discs_is_that_of_their_centres_less_both_radii(record_of):
    found = figures(record_of, lines(((0, 0), (4, 0)), ((4, 1), (0, 1))))
    assert found["distance_min"] == pytest.approx(1.0 - 2 * 0.2)


def test_least_gap_between_boxes_is_that_of_their_sides(record_of):
    box = [[0.3, -0.1], [0.3, 0.1], [-0.3, 0.1], [-0.3, -0.1]]
    body = {"footprint": {"radius": 0.32, "vertices_xy": box}}
    beside = figures(record_of, lines(((0, 0), (4, 0)), ((4, 1), (0, 1))), robot=body)
    ahead = figures(record_of, lines(((0, 0), (1, 0)), ((2, 0), (2, 0.0))), robot=body)
    assert beside["distance_min"] == pytest.approx(0.8)
    assert ahead["distance_min"] == pytest.approx(0.4)


def test_least_gap_and_delay_of_a_mixed_team_are_those_of_each_type(record_of):
    box = {"radius": 0.32, "vertices_xy": [[0.3, -0.1], [0.3, 0.1], [-0.3, 0.1], [-0.3, -0.1]]}
    disc = {"radius": 0.2, "vertices_xy": []}
    types = [{"footprint": box, "limits": FAST}, {"footprint": disc, "limits": {**FAST, "vx_max": 1.0}}]
    track = lines(((0, 0), (4, 0)), ((4, 1), (0, 1)))
    for member in range(2):
        found = figures(record_of, track, (), (10.0, 10.0), member, robot=types[member], types=types)
        assert found["distance_min"] == pytest.approx(1.0 - 0.1 - 0.2)
        assert found["delay"] == pytest.approx(10.0 - (8.0, 4.0)[member])


def test_contacts_with_robots_are_those_of_kind_robot(record_of):
    touched = {"contact_stamp": [1.0, 2.0, 3.0], "contact_kind": [3, 2, 3], "contact_person": [1, 4, 1]}
    found = figures(record_of, lines(((0, 0), (4, 0)), ((4, 1), (0, 1))), **touched)
    assert found["robot_collisions"] == 2.0


def stopped(places, after, seconds):
    """Return a track of robots that drive to places 3 m ahead along x until ``after`` s and then stand."""
    times = np.minimum(0.1 * np.arange(round(10 * seconds) + 1) / after, 1.0)[:, None]
    return np.stack([np.array(place) + times * (3.0, 0.0) for place in places], axis=1)


def test_two_who_stand_face_to_face_for_ten_seconds_are_one_deadlock(record_of):
    stuck = stopped([(0, 0), (0, 1)], 5.0, 30.0)
    assert figures(record_of, stuck, ("time_out", "time_out"))["deadlocks"] == 1.0
    short = stopped([(0, 0), (0, 1)], 5.0, 14.0)
    assert figures(record_of, short, ("time_out", "time_out"))["deadlocks"] == 0.0


def test_who_stands_alone_or_has_arrived_is_in_no_deadlock(record_of):
    far = stopped([(0, 0), (0, 5)], 5.0, 30.0)
    assert figures(record_of, far, ("time_out", "time_out"))["deadlocks"] == 0.0
    arrived = stopped([(0, 0), (0, 1)], 5.0, 30.0)
    assert figures(record_of, arrived, ("goal_reached", "time_out"), (5.0, 30.0))["deadlocks"] == 0.0


def test_two_clusters_are_two_deadlocks_and_so_are_two_times(record_of):
    apart = stopped([(0, 0), (0, 1), (0, 9), (0, 10)], 5.0, 30.0)
    assert figures(record_of, apart, ["time_out"] * 4)["deadlocks"] == 2.0
    first = stopped([(0, 0), (0, 1)], 5.0, 20.0)
    twice = np.concatenate((first, first[-1, 0, 0] + stopped([(0, 0), (0, 1)], 5.0, 20.0) * (1, 1)))
    twice[len(first) :, :, 1] -= first[-1, 0, 0]
    assert figures(record_of, twice, ["time_out"] * 2)["deadlocks"] == 2.0


def test_a_robot_alone_has_none_of_these_figures(record_of, straight_line):
    pack: TeamMetrics = component("metrics", "team", [])
    record = record_of(straight_line(3.0, 0.5))
    assert all(np.isnan(metric.compute(record)) for metric in pack.metrics())
