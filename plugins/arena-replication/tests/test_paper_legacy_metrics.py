"""The figures of pack paper_legacy, with the oddities of the release."""

import math

import numpy as np
import pytest

from arena_replication.paper_legacy import PaperLegacyMetrics, goal_row, recorded_rows


def far_goal(**changes):
    base = {
        "name": "s",
        "seed": 0,
        "start": [0, 0, 0],
        "goal": [50.0, 0.0, 0.0],
        "goal_radius": 0.3,
        "time_limit": 180.0,
        "obstacles": [],
    }
    return {"scenario": base | changes, "outcome": "time_out"}


def forward(speeds, dt=0.4, **more):
    """Poses and twists along x with one record a step, the last row without command."""
    vx = np.asarray(speeds, dtype=float)
    pose = np.stack((np.concatenate(([0.0], np.cumsum(vx[:-1] * dt))), 0 * vx, 0 * vx), axis=1)
    return {"poses": pose, "twist": np.stack((vx, 0 * vx, 0 * vx), axis=1), "dt": dt, "meta": far_goal(), **more}


def test_rows_are_kept_every_record_period():
    assert recorded_rows(0.1 * np.arange(14), 0.4) == [0, 4, 8, 12]
    assert recorded_rows(0.3 * np.arange(7), 0.4) == [0, 2, 4, 6]
    assert recorded_rows(1e17 + 100.0 * np.arange(3), 0.4) == [0, 1, 2]  # no float of that size is 0.4 further


def test_differences_are_per_record_and_signed(legacy, record_of):
    record = record_of(**forward([0.0, 0.2, 0.6, 0.4, 0.4, 0.0]))  # the last row has no command
    assert legacy["velocity"](record) == pytest.approx((0.2 + 0.6 + 0.4 + 0.4) / 5)
    assert legacy["acceleration"](record) == pytest.approx((0.2 + 0.4 - 0.2) / 3)
    assert legacy["jerk"](record) == pytest.approx((0.2 + 0.6 + 0.2) / 3)


def test_record_period_does_not_scale_the_jerk(legacy, record_of):
    speeds = [0.0, 0.2, 0.6, 0.4, 0.4, 0.0]
    assert legacy["jerk"](record_of(**forward(speeds, dt=0.4))) == pytest.approx(
        legacy["jerk"](record_of(**forward(speeds, dt=0.8)))
    )


def test_values_are_rounded_to_three_decimals(legacy, record_of):
    record = record_of(**forward([0.1234, 0.1234, 0.1234, 0.1234]))
    assert legacy["velocity"](record) == pytest.approx(0.123, abs=1e-12)


def test_crossing_pi_adds_two_pi(legacy, record_of):
    record = record_of(**forward([1.0, 1.0, 1.0, 0.0]))
    record["pose"][:, 2] = 3.1, -3.1, -3.1, -3.1
    assert legacy["angle_over_length"](record) == pytest.approx(6.2 / 0.8)


def test_angle_over_length_of_a_standing_robot_is_undefined_not_infinite(legacy, record_of):
    assert math.isnan(legacy["angle_over_length"](record_of(**forward([0.0, 0.0, 0.0, 0.0]))))


def test_collision_is_a_rising_edge_at_the_evaluation_radius(legacy, record_of):
    laser = np.array([0.5, 0.121, 0.1, 0.5, 0.115, 0.122, np.nan])
    record = record_of(**forward([0.1] * 7, scan_min=laser))
    assert legacy["collision"](record) == 2.0


def test_first_record_in_contact_is_a_collision_and_staying_in_contact_no_other(legacy, record_of):
    """A robot that drives with its scanner below the radius all the time collides once: the release's blind spot."""
    record = record_of(**forward([0.1] * 7, scan_min=np.full(7, 0.05)))
    assert legacy["collision"](record) == 1.0


def test_other_robots_collide_at_their_own_radius(legacy, record_of):
    footprint = {"radius": 0.4, "vertices_xy": []}
    meta = far_goal() | {"robot": {"name": "fourth", "footprint": footprint}}
    record = record_of(**{**forward([0.1] * 4, scan_min=np.array([1.0, 0.39, 1.0, 1.0])), "meta": meta})
    assert legacy["collision"](record) == 1.0


def test_clearing_distance_is_the_mean_nearest_return(legacy, record_of):
    record = record_of(**forward([0.1] * 5, scan_min=np.array([1.0, np.inf, 2.0, 3.0, np.nan])))
    assert legacy["clearing_distance_min"](record) == pytest.approx(2.0)


def test_triangle_figures_are_those_of_the_records(legacy, record_of):
    parts = forward([1.0] * 4)
    parts["poses"] = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 0]], dtype=float)
    record = record_of(**parts)
    curvature = 4 * 0.5 / math.sqrt(2)
    assert legacy["curvature"](record) == pytest.approx(curvature)
    assert legacy["curvature_max"](record) == pytest.approx(curvature)
    assert legacy["curvature_normalised"](record) == pytest.approx(2 * curvature)
    assert legacy["roughness"](record) == pytest.approx(0.5)


def test_coincident_records_leave_the_curvature_undefined(legacy, record_of):
    record = record_of(**forward([0.0] * 6))
    assert math.isnan(legacy["curvature"](record))
    assert math.isnan(legacy["roughness"](record))


def test_episode_ends_at_the_first_half_second_check_within_a_metre(legacy, record_of, straight_line):
    """0.5 m/s towards a goal 4 m away: nearer than 1 m after 6.0 s, seen at the check of 6.5 s."""
    record = record_of(straight_line(length=4.0, speed=0.5))
    assert record["stamp"][goal_row(record, 1.0, 0.5)] == pytest.approx(6.5)
    assert legacy["success"](record) == 1.0
    assert legacy["time"](record) == pytest.approx(6.4)
    assert legacy["path_length"](record) == pytest.approx(3.2)


def test_two_collisions_succeed_and_three_do_not(legacy, record_of, straight_line):
    pose = straight_line(length=8.0)
    laser = np.ones(len(pose))
    laser[[8, 40]] = 0.1
    assert legacy["success"](record_of(pose, scan_min=laser)) == 1.0
    laser[80] = 0.1
    assert legacy["success"](record_of(pose, scan_min=laser)) == 0.0


def test_arrival_after_the_time_out_fails(legacy, record_of, straight_line):
    slow = straight_line(length=4.0, speed=0.5)
    assert legacy["success"](record_of(slow, dt=3.0)) == 0.0
    assert legacy["success"](record_of(slow, dt=2.0)) == 1.0


def test_episode_that_ended_far_from_the_goal_fails(legacy, record_of, straight_line):
    assert legacy["success"](record_of(straight_line(), meta=far_goal())) == 0.0


def test_rows_up_to_a_jump_are_dropped(legacy, record_of):
    parts = forward([0.5] * 8)
    parts["poses"][2:, 0] += 10.0
    record = record_of(**parts)
    assert legacy["path_length"](record) == pytest.approx(3 * 0.2)
    assert legacy["time"](record) == pytest.approx(3 * 0.4)


def test_rows_with_a_speed_component_of_three_are_dropped(legacy, record_of):
    record = record_of(**forward([0.5, 3.0, 2.999, 0.5, 0.5]))
    assert legacy["velocity"](record) == pytest.approx((0.5 + 2.999 + 0.5) / 3)


@pytest.fixture(scope="module")
def published(preset_of):
    return {metric.name: metric.compute for metric in PaperLegacyMetrics(**preset_of("paper_published")).metrics()}


def test_published_rows_are_of_all_digits(published, record_of):
    record = record_of(**forward([0.1234, 0.1234, 0.1234, 0.1234]))
    assert published["velocity"](record) == pytest.approx(0.1234, abs=1e-12)
    assert published["path_length"](record) == pytest.approx(2 * 0.4 * 0.1234, abs=1e-12)


def test_published_rows_keep_jumps_and_high_speeds(published, record_of):
    parts = forward([0.5, 3.5, 0.5, 0.5, 0.5, 0.5])
    parts["poses"][3:, 0] += 10.0
    record = record_of(**parts)
    assert published["path_length"](record) == pytest.approx(0.2 + 1.4 + 10.2 + 0.2)
    assert published["velocity"](record) == pytest.approx((4 * 0.5 + 3.5) / 5)
    assert published["time"](record) == pytest.approx(4 * 0.4)


def test_published_rows_differ_from_the_script_by_rounding_and_cleaning_alone(published, legacy, record_of, round_trip):
    """Where all values have three decimals and nothing is cleaned, the two are one."""
    record = record_of(round_trip(radius=2.0), dt=0.4, meta=far_goal())
    for name in ("pose", "twist", "stamp", "scan_min"):
        record.arrays[name][:] = record[name].round(3)
    assert {name: compute(record) for name, compute in published.items()} == {
        name: compute(record) for name, compute in legacy.items()
    }


def test_presets_differ_in_these_keys_alone(preset_of):
    ours, theirs = preset_of("paper_published"), preset_of("paper_legacy")
    assert {key for key in theirs if ours[key] != theirs[key]} == {"decimals", "speed_max", "jump_max"}
    assert ours.keys() == theirs.keys()
