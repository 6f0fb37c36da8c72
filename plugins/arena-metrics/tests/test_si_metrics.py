"""The figures of pack si, each worked out by hand."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_metrics.packs.motion import contact_spans, menger_curvatures, resample_by_length, velocities_map

GEOMETRY = [
    "path_length",
    "curvature_mean",
    "curvature_max",
    "curvature_min",
    "curvature_normalised",
    "angle_over_length",
    "roughness",
]


def scenario(**changes):
    base = {
        "name": "s",
        "seed": 0,
        "start": [0, 0, 0],
        "goal": [4.0, 0.0, 0.0],
        "goal_radius": 0.3,
        "time_limit": 180.0,
        "obstacles": [],
    }
    return {"scenario": base | changes}


def contacts(count, caused=None, speeds=None):
    return {
        "contact_stamp": np.arange(count, dtype=float),
        "contact_caused": np.zeros(count, bool) if caused is None else np.array(caused),
        "contact_speed": np.zeros(count) if speeds is None else np.array(speeds),
    }


def test_straight_line_has_its_length_speed_and_no_bend(si, record_of, straight_line):
    record = record_of(straight_line(length=4.0, speed=0.5))
    values = {name: compute(record) for name, compute in si.items()}
    assert values["path_length"] == pytest.approx(4.0)
    assert values["velocity"] == pytest.approx(0.5)
    assert values["time_to_goal"] == pytest.approx(8.0)
    zero = [
        "acceleration",
        "jerk",
        "curvature_mean",
        "curvature_max",
        "curvature_min",
        "angle_over_length",
        "roughness",
        "goal_error",
    ]
    assert {name: values[name] for name in zero} == pytest.approx(dict.fromkeys(zero, 0.0), abs=1e-9)


def test_circle_has_curvature_one_over_radius_and_centripetal_acceleration(si, record_of, round_trip):
    radius, speed = 2.0, 0.5
    record = record_of(round_trip(radius, speed))
    for name in ("curvature_mean", "curvature_max", "curvature_min", "angle_over_length"):
        assert si[name](record) == pytest.approx(1.0 / radius, rel=1e-2)
    assert si["acceleration"](record) == pytest.approx(speed**2 / radius, rel=1e-2)
    assert si["jerk"](record) == pytest.approx(speed**3 / radius**2, rel=1e-2)


def test_normalised_curvature_and_roughness_of_a_circle_follow_from_the_step(si, record_of, round_trip):
    step, radius = 0.1, 2.0
    record = record_of(round_trip(radius))
    assert si["curvature_normalised"](record) == pytest.approx(2.0 * step / radius, rel=1e-2)
    assert si["roughness"](record) == pytest.approx(math.tan(step / radius / 2.0) / 2.0, rel=1e-2)


def test_full_turn_crossing_pi_counts_two_pi(si, record_of, round_trip):
    record = record_of(round_trip(radius=1.0, turns=1.0))
    assert si["angle_over_length"](record) * si["path_length"](record) == pytest.approx(2.0 * math.pi, rel=1e-2)


def test_stop_and_go_acceleration_is_speed_change_over_time(si, record_of, straight_line):
    """2 s at 0.6 m/s, 2 s standing, 2 s at 0.6 m/s: two changes of 0.6 m/s in 6 s are 0.2 m/s^2 on average."""
    pose = straight_line(length=3.6, speed=0.6)
    vx = np.repeat([0.6, 0.0, 0.6], [20, 20, 21])
    record = record_of(pose, twist=np.stack((vx, 0 * vx, 0 * vx), axis=1))
    assert si["acceleration"](record) == pytest.approx(1.2 / 6.0)
    # each change is an acceleration of 3 m/s^2 in one 0.2 s sample: four jerks of 15 m/s^3 in 29
    assert si["jerk"](record) == pytest.approx(4 * 15.0 / 29)


def test_standing_robot_has_no_curvature_and_no_angle_over_length(si, record_of):
    turning = np.zeros((50, 3))
    turning[:, 2] = np.linspace(0, 3, 50)
    record = record_of(turning)
    for name in (
        "curvature_mean",
        "curvature_max",
        "curvature_min",
        "curvature_normalised",
        "angle_over_length",
        "roughness",
    ):
        assert math.isnan(si[name](record))
    assert si["path_length"](record) == 0.0
    assert si["velocity"](record) == 0.0


def test_standing_still_on_the_way_leaves_the_path_as_it_is(si, record_of, round_trip):
    pose = round_trip()
    waiting = np.concatenate((pose[:40], np.repeat(pose[40:41], 30, axis=0), pose[40:]))
    for name in GEOMETRY:
        assert si[name](record_of(waiting)) == pytest.approx(si[name](record_of(pose)))


def test_reversal_counts_the_limit_and_stays_finite():
    there_and_back = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]])
    curvature, _ = menger_curvatures(there_and_back, step=0.1)
    assert curvature.max() == pytest.approx(20.0)
    assert np.count_nonzero(curvature > 1e-6) == 1


def test_there_and_back_roughness_counts_one_for_the_reversal(si, record_of):
    x = np.concatenate((np.linspace(0, 1, 21), np.linspace(1, 0, 21)[1:]))
    record = record_of(np.stack((x, 0 * x, 0 * x), axis=1))
    assert si["roughness"](record) == pytest.approx(1.0 / 19)


def test_success_needs_arrival_truth_time_and_few_collisions(si, record_of, straight_line):
    pose = straight_line()
    assert si["success"](record_of(pose)) == 1.0
    assert si["success"](record_of(pose, meta={"outcome": "time_out"})) == 0.0
    assert si["success"](record_of(pose, meta={"outcome": "error"})) == 0.0
    assert si["success"](record_of(pose, meta=scenario(goal=[4.54, 0.0, 0.0]))) == 1.0
    assert si["success"](record_of(pose, meta=scenario(goal=[4.56, 0.0, 0.0]))) == 0.0
    assert si["success"](record_of(pose, meta=scenario(time_limit=7.9))) == 0.0
    assert si["success"](record_of(pose, **contacts(1))) == 1.0
    assert si["success"](record_of(pose, **contacts(2))) == 0.0


def test_strict_success_allows_no_collision(si, record_of, straight_line):
    assert si["strict_success"](record_of(straight_line())) == 1.0
    assert si["strict_success"](record_of(straight_line(), **contacts(1))) == 0.0


def test_contacts_are_counted_timed_and_their_speed_is_the_greatest(si, record_of, straight_line):
    pose = straight_line()
    seconds = np.zeros(len(pose))
    seconds[[10, 11, 40]] = 0.1, 0.03, 0.05
    record = record_of(pose, contact_time=seconds, **contacts(3, [True, False, True], [0.2, 0.7, 0.1]))
    assert si["collisions"](record) == 3.0
    assert si["collisions_caused"](record) == 2.0
    assert si["contact_time"](record) == pytest.approx(0.18)
    assert si["impact_speed"](record) == pytest.approx(0.7)


def test_contacts_are_told_apart_by_what_was_touched_and_who_caused_them(si, record_of, straight_line):
    record = record_of(
        straight_line(),
        **contacts(5, [True, True, False, True, False]),
        contact_kind=np.array([0, 1, 2, 2, 2], np.int8),
    )
    assert si["collisions_static"](record) == 2.0
    assert si["collisions_people"](record) == 3.0
    assert si["collisions_people_caused"](record) == 1.0
    assert si["collisions"](record) == si["collisions_static"](record) + si["collisions_people"](record)


def test_share_of_time_in_reverse_is_that_of_the_backward_twist(si, record_of, straight_line):
    """10 s, of which rows 3.0 .. 5.0 s go back: 2.0 s and half a step at either end."""
    pose = straight_line(length=5.0, speed=0.5)
    vx = np.where((np.arange(101) >= 30) & (np.arange(101) <= 50), -0.1, 0.5)
    record = record_of(pose, twist=np.stack((vx, 0 * vx, 0 * vx), axis=1))
    assert si["reverse_share"](record) == pytest.approx(0.21)
    assert si["reverse_share"](record_of(pose)) == 0.0
    assert si["reverse_share"](record_of(pose, twist=np.tile([-0.01, 0.0, 0.3], (101, 1)))) == 0.0
    assert math.isnan(si["reverse_share"](record_of(pose[:1])))


def test_a_blow_counts_as_a_jerk_and_is_left_out_of_the_one_without_contact(si, record_of, straight_line):
    """0.6 m/s, stopped at 2.0 s by a wall that is touched in the steps that end at 2.1 s and 2.2
    s; the jerk is all in the blow.
    """
    pose = straight_line(length=3.6, speed=0.6)
    vx = np.where(np.arange(61) > 20, 0.0, 0.6)
    seconds = np.zeros(61)
    seconds[21:23] = 0.1
    blow = record_of(pose, twist=np.stack((vx, 0 * vx, 0 * vx), axis=1), contact_time=seconds)
    assert si["jerk"](blow) > 0.5
    assert si["jerk_without_contact"](blow) == 0.0
    untouched = record_of(pose, twist=blow["twist"])
    assert si["jerk_without_contact"](untouched) == si["jerk"](untouched)


def test_jerk_without_contact_is_undefined_where_the_robot_always_touches(si, record_of, straight_line):
    pose = straight_line()
    assert math.isnan(si["jerk_without_contact"](record_of(pose, contact_time=np.full(len(pose), 0.1))))


@pytest.mark.parametrize(("step", "left_out"), [(1, 1), (20, 2), (21, 2), (22, 2), (60, 1)])
def test_a_step_in_contact_takes_the_triples_that_share_time_with_it(si, record_of, straight_line, step, left_out):
    """Triples of 0.2 s begin at 0.0, 0.2 .. 5.6 s; a speed of t^2 has a jerk of 2 m/s^3 in each,
    but for what the mark adds.
    """
    rows = np.arange(61)
    seconds = np.zeros(61)
    seconds[step] = 0.05
    record = record_of(
        np.zeros((61, 3)), twist=np.stack((0.01 * rows**2, 0 * rows, 0 * rows), axis=1), contact_time=seconds
    )
    begins = 0.2 * np.arange(29)
    shares = (begins < 0.1 * step - 1e-9) & (begins + 0.4 > 0.1 * (step - 1) + 1e-9)
    assert np.count_nonzero(contact_spans(record, begins, begins + 0.4)) == np.count_nonzero(shares) == left_out
    assert si["jerk_without_contact"](record) == pytest.approx(2.0)


def test_impact_speed_is_undefined_without_contact(si, record_of, straight_line):
    assert math.isnan(si["impact_speed"](record_of(straight_line())))


def test_time_to_goal_is_undefined_unless_the_goal_was_reached(si, record_of, straight_line):
    assert math.isnan(si["time_to_goal"](record_of(straight_line(), meta={"outcome": "false_arrival"})))


def test_goal_error_is_the_true_distance_not_the_estimated_one(si, record_of, straight_line):
    pose = straight_line()
    record = record_of(pose, meta=scenario(goal=[4.3, 0.4, 0.0]), estimate=pose + 9.0)
    assert si["goal_error"](record) == pytest.approx(0.5)


def test_spl_is_first_path_over_path_driven(si, record_of, straight_line):
    pose = straight_line(length=4.0)
    paths = {"path_poses": [[0, 0, 0], [3, 0, 0], [0, 0, 0], [9, 0, 0]], "path_offsets": np.array([0, 2, 4])}
    assert si["spl"](record_of(pose, **paths)) == pytest.approx(0.75)
    assert si["spl"](record_of(pose, meta={"outcome": "time_out"}, **paths)) == 0.0
    assert si["spl"](record_of(pose)) == pytest.approx(1.0)


def test_clearance_leaves_out_steps_without_anything_near(si, record_of, straight_line):
    pose = straight_line()
    clearance = np.full(len(pose), np.inf)
    assert math.isnan(si["clearance_mean"](record_of(pose, clearance=clearance)))
    clearance[:4] = 0.5, 1.0, 2.0, 0.5
    record = record_of(pose, clearance=clearance)
    assert (si["clearance_mean"](record), si["clearance_max"](record), si["clearance_min"](record)) == (1.0, 2.0, 0.5)
    assert si["clearance_normalised"](record) == pytest.approx(1.0 / 0.2)


def test_personal_space_is_timed_and_encounters_are_counted_by_their_begin(si, record_of, straight_line):
    pose = straight_line()
    near = np.full(len(pose), 5.0)
    near[10:21] = 1.1  # 1.0 s between the stamps, and half a step at either end
    near[15:17] = 0.9
    near[40] = 0.3
    record = record_of(pose, clearance_people=near)
    assert si["personal_space_time"](record) == pytest.approx(1.1 + 0.1)
    assert si["encounters"](record) == 2.0
    assert si["clearance_people_min"](record) == pytest.approx(0.3)


def test_who_is_not_in_the_world_is_not_near(si, record_of, straight_line):
    pose = straight_line()
    near = np.where(np.arange(len(pose)) < 20, 0.4, np.inf)  # with no one else in the world
    record = record_of(pose, clearance_people=near, pedestrian_positions=np.full((len(pose), 1, 2), np.nan, np.float32))
    assert si["clearance_people_min"](record) == pytest.approx(0.4)
    assert si["encounters"](record) == 1.0
    assert si["personal_space_time"](record) == pytest.approx(1.95)


def test_first_plan_is_no_replan_and_refusals_are_counted_apart(si, record_of, straight_line):
    kinds = [("replan", "start"), ("replan", "blocked"), ("no_valid_command", "boxed in"), ("replan", "period")]
    events = [{"stamp": float(i), "kind": kind, "detail": detail} for i, (kind, detail) in enumerate(kinds)]
    record = record_of(straight_line(), meta={"events": events})
    assert si["replans"](record) == 2.0
    assert si["no_valid_command"](record) == 1.0
    assert si["recoveries"](record) == 0.0


def test_recoveries_are_counted(si, record_of, straight_line):
    events = [
        {"stamp": float(i), "kind": kind, "detail": "turn"} for i, kind in enumerate(("recovery", "replan", "recovery"))
    ]
    assert si["recoveries"](record_of(straight_line(), meta={"events": events})) == 2.0


def test_the_longest_stand_is_the_longest_time_in_one_place(si, record_of, straight_line):
    driving = straight_line()
    swinging = driving[-1] + np.array([0.1, 0.0, 0.5]) * np.where(np.arange(80) % 2, 1.0, -1.0)[:, None]
    record = record_of(np.concatenate((driving, swinging)))
    period = record["stamp"][1] - record["stamp"][0]
    assert si["longest_stand"](record) == pytest.approx(80 * period, abs=0.3 / 0.5)
    assert si["longest_stand"](record_of(driving)) < 1.0


def test_planning_time_is_in_milliseconds_and_undefined_without_timing(si, record_of, straight_line):
    record = record_of(straight_line())
    record.timing["planner_seconds"][:] = np.linspace(0.0, 0.1, len(record.timing["planner_seconds"]))
    assert si["planning_time_mean"](record) == pytest.approx(50.0)
    assert si["planning_time_p95"](record) == pytest.approx(95.0)
    assert math.isnan(si["planning_cpu_p99"](record))
    record.timing["planner_cpu_seconds"] = np.linspace(0.0, 0.1, 101)
    assert si["planning_cpu_p99"](record) == pytest.approx(99.0)
    assert si["planning_cpu_mean"](record) == pytest.approx(50.0)
    record.timing.clear()
    assert math.isnan(si["planning_time_mean"](record))


def test_steps_that_waited_for_a_compiler_are_left_out_of_times(record_of, straight_line, si):
    record = record_of(straight_line())
    record.timing["planner_seconds"][:] = 0.002
    record.timing["planner_seconds"][0] = np.nan
    assert si["planning_time_mean"](record) == pytest.approx(2.0)
    assert si["planning_time_p99"](record) == pytest.approx(2.0)


def test_times_of_local_map_and_tracker_stand_apart_and_are_undefined_in_older_records(si, record_of, straight_line):
    record = record_of(straight_line())
    parts = {
        "local_map": 0.004,
        "local_map_cpu": 0.008,
        "tracker": 0.001,
        "tracker_cpu": 0.002,
        "navigator": 0.01,
        "navigator_cpu": 0.03,
    }
    assert all(
        math.isnan(si[name](record))
        for name in si
        if name.startswith(("planning_local", "planning_tracker", "planning_navigator"))
    )
    record.timing.update({f"{part}_seconds": np.array([0.0, 2.0 * seconds]) for part, seconds in parts.items()})
    names = ("planning_local_map_time", "planning_local_map_cpu", "planning_tracker_time", "planning_tracker_cpu")
    assert [si[name](record) for name in names] == pytest.approx([4.0, 8.0, 1.0, 2.0])
    assert (si["planning_navigator_time"](record), si["planning_navigator_cpu"](record)) == pytest.approx((10.0, 30.0))


def test_localization_error_is_the_mean_over_steps_with_an_estimate(si, record_of, straight_line):
    pose = straight_line()
    estimate = pose + np.array([0.3, 0.4, 0.0])
    estimate[-1] = np.nan
    assert si["localization_error"](record_of(pose, estimate=estimate)) == pytest.approx(0.5)
    assert math.isnan(si["localization_error"](record_of(pose, estimate=np.full_like(pose, np.nan))))


@pytest.mark.parametrize("rows", [1, 2])
def test_episode_that_ended_at_once_gives_figures_or_nan(si, legacy, record_of, straight_line, rows):
    record = record_of(straight_line()[:rows], meta={"outcome": "error", "error": "boom"})
    for compute in [*si.values(), *legacy.values()]:
        value = compute(record)
        assert isinstance(value, float)
        assert not math.isinf(value)


def test_velocities_are_turned_into_the_map_frame(straight_line):
    pose = straight_line()
    pose[:, 2] = math.pi / 2
    sampled = velocities_map(0.1 * np.arange(len(pose)), pose, np.tile([0.5, 0.2, 0.0], (len(pose), 1)), 0.2)
    assert sampled == pytest.approx(np.tile([-0.2, 0.5], (len(sampled), 1)))


turns = st.lists(st.floats(-0.4, 0.4), min_size=10, max_size=60)


def winding(angles):
    heading = np.cumsum(angles)
    position = 0.06 * np.cumsum(np.stack((np.cos(heading), np.sin(heading)), axis=1), axis=0)
    return np.concatenate((position, ((heading + np.pi) % (2 * np.pi) - np.pi)[:, None]), axis=1)


@settings(derandomize=True, deadline=None, max_examples=60)
@given(turns, st.floats(-3.1, 3.1), st.floats(-50, 50), st.floats(-50, 50))
def test_rotating_and_shifting_the_world_changes_no_figure(si, record_of, angles, rotation, x, y):
    pose = winding(angles)
    c, s = math.cos(rotation), math.sin(rotation)
    moved = pose.copy()
    moved[:, :2] = pose[:, :2] @ np.array([[c, s], [-s, c]]) + (x, y)
    moved[:, 2] = (pose[:, 2] + rotation + np.pi) % (2 * np.pi) - np.pi
    for name in [*GEOMETRY, "velocity", "acceleration", "jerk"]:
        assert si[name](record_of(moved)) == pytest.approx(si[name](record_of(pose)), rel=1e-5, abs=1e-6, nan_ok=True)


@settings(derandomize=True, deadline=None, max_examples=60)
@given(turns, st.floats(0.2, 5.0))
def test_driving_the_same_path_slower_keeps_geometry_and_scales_speed(si, record_of, angles, factor):
    pose = winding(angles)
    usual, slow = record_of(pose, dt=0.1), record_of(pose, dt=0.1 * factor)
    for name in GEOMETRY:
        assert si[name](slow) == pytest.approx(si[name](usual), nan_ok=True)
    assert si["velocity"](slow) == pytest.approx(si["velocity"](usual) / factor)


@settings(derandomize=True, deadline=None, max_examples=60)
@given(turns, st.floats(0.02, 0.3))
def test_resampled_points_lie_a_step_apart_along_the_path(angles, step):
    points = winding(angles)[:, :2]
    sampled = resample_by_length(points, step)
    gaps = np.hypot(*np.diff(sampled, axis=0).T)
    assert (gaps <= step + 1e-9).all()
    assert sampled[0] == pytest.approx(points[0])


def test_people_are_counted_per_free_ground(si, record_of, straight_line):
    pose = straight_line()
    positions = np.zeros((len(pose), 2, 2))
    positions[:, 1] = np.nan  # who is not there does not count
    record = record_of(pose, meta={"world": {"free_area": 25.0}}, pedestrian_positions=positions)
    assert si["people_per_100m2"](record) == pytest.approx(4.0)
    assert math.isnan(si["people_per_100m2"](record_of(pose)))


def test_a_whole_episode_is_timed_in_seconds_and_undefined_in_older_records(si, record_of, straight_line):
    record = record_of(straight_line())
    assert math.isnan(si["planning_episode_time"](record))
    record.timing.update({"episode_seconds": np.array([12.0]), "episode_cpu_seconds": np.array([9.0])})
    assert (si["planning_episode_time"](record), si["planning_episode_cpu"](record)) == (12.0, 9.0)
