"""Collision courses with people: times and distances worked out by hand, and against a simulation in small steps."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_metrics.packs.collision_courses import times_to_collision
from arena_metrics.packs.footprints import outline_distances, times_to_contact

DISC = {"radius": 0.2, "vertices_xy": []}
BOX = {"radius": math.hypot(0.3, 0.2), "vertices_xy": [[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]]}


def crowd(rows, *people, radius=0.3):
    """People who walk straight on: each (x, y, vx, vy) at the first row, rows 0.1 s apart; None: not in the world."""
    ways = [person or (math.nan,) * 4 for person in people]
    start, speed = (np.array([way[i : i + 2] for way in ways]) for i in (0, 2))
    return {
        "pedestrian_ids": np.arange(7, 7 + len(people), dtype=np.int32),
        "pedestrian_radii": np.full(len(people), radius),
        "pedestrian_positions": start + 0.1 * np.arange(rows)[:, None, None] * speed,
        "pedestrian_velocities": np.broadcast_to(speed, (rows, len(people), 2)),
    }


def touched(stamp, person=7, caused=True):
    one = {"contact_stamp": [stamp], "contact_kind": [2], "contact_person": [person], "contact_caused": [caused]}
    return {**one, "contact_speed": [0.5], "contact_position": [[0.0, 0.0]]}


def test_time_to_collision_head_on_is_gap_over_closing_speed(si, record_of, straight_line):
    """From (0, 0) at 0.5 m/s towards a person at x = 4.5 who comes at 0.5 m/s: 4 m between discs
    of 0.2 m and 0.3 m, 1 m/s.
    """
    pose = straight_line(length=1.0, speed=0.5)
    record = record_of(pose, **crowd(len(pose), (4.5, 0.0, -0.5, 0.0)))
    assert times_to_collision(record, 5.0)[:, 0] == pytest.approx(4.0 - 0.1 * np.arange(len(pose)))
    assert si["time_to_collision_min"](record) == pytest.approx(2.0)


def test_who_passes_by_or_is_overtaken_by_nobody_is_no_threat(si, record_of, straight_line):
    pose = straight_line(length=1.0)
    ways = [(4.0, 0.51, -1.0, 0.0), (4.0, 0.0, 0.5, 0.0), (-2.0, 0.0, -1.0, 0.0), None]
    record = record_of(pose, **crowd(len(pose), *ways))
    assert np.isinf(times_to_collision(record, 5.0)).all()
    assert si["time_to_collision_min"](record) == 3.0
    assert math.isnan(si["reaction_distance"](record))


def test_a_collision_beyond_the_horizon_counts_as_the_horizon(si, record_of, straight_line):
    pose = straight_line(length=1.0)
    assert si["time_to_collision_min"](record_of(pose, **crowd(len(pose), (9.0, 0.0, -0.2, 0.0)))) == 3.0


def test_without_people_there_is_no_time_to_collision(si, record_of, straight_line):
    pose = straight_line()
    assert math.isnan(si["time_to_collision_min"](record_of(pose)))
    assert math.isnan(si["time_to_collision_min"](record_of(pose, **crowd(len(pose), None))))
    assert math.isnan(si["reaction_distance"](record_of(pose)))


def test_a_contact_with_a_person_is_a_time_of_zero_and_one_with_a_wall_is_not(si, record_of, straight_line):
    pose = straight_line(length=1.0)
    people = crowd(len(pose), (9.0, 9.0, 0.0, 0.0))
    assert si["time_to_collision_min"](record_of(pose, **people, **touched(0.5))) == 0.0
    assert si["time_to_collision_min"](record_of(pose, **people, **touched(0.5) | {"contact_kind": [0]})) == 3.0


def braking(at, rows=40, speed=0.5):
    """Poses and twist of a robot that drives along x and stops in row ``at``."""
    vx = np.where(np.arange(rows) < at, speed, 0.0)
    x = np.concatenate(([0.0], np.cumsum(0.1 * vx[:-1])))
    return np.stack((x, 0 * x, 0 * x), axis=1), np.stack((vx, 0 * vx, 0 * vx), axis=1)


def test_reaction_distance_is_the_gap_when_the_robot_brakes(si, record_of):
    """It stops at x = 1 m, 20 steps on; who stands at 2.4 m is then 2.4 - 1 - 0.2 - 0.3 = 0.9 m away."""
    pose, twist = braking(20)
    assert si["reaction_distance"](record_of(pose, twist=twist, **crowd(40, (2.4, 0.0, 0.0, 0.0)))) == pytest.approx(
        0.9
    )


def test_reaction_by_turning_away_counts_too(si, record_of):
    vx, vy = np.full(40, 0.5), np.where(np.arange(40) < 10, 0.0, 0.4)
    pose = np.stack((0.05 * np.arange(40), np.concatenate(([0.0], np.cumsum(0.1 * vy[:-1]))), np.zeros(40)), axis=1)
    twist = np.stack((vx, vy, 0 * vx), axis=1)
    assert si["reaction_distance"](record_of(pose, twist=twist, **crowd(40, (1.9, 0.0, 0.0, 0.0)))) == pytest.approx(
        1.9 - 0.5 - 0.5
    )


def test_who_steps_aside_is_not_reacted_to(si, record_of, straight_line):
    pose = straight_line(length=3.0)
    people = crowd(len(pose), (1.9, 0.0, 0.0, 0.0))
    people["pedestrian_positions"][10:, 0, 1] = 2.0
    assert math.isnan(si["reaction_distance"](record_of(pose, **people)))


def test_who_is_touched_before_any_reaction_counts_zero(si, record_of):
    pose, twist = braking(20)
    people = crowd(40, (1.5, 0.0, 0.0, 0.0))
    assert si["reaction_distance"](record_of(pose, twist=twist, **people, **touched(1.95))) == 0.0


def test_a_glance_in_passing_is_no_course(si, record_of):
    """The robot turns on its way, and for 0.3 s it would have met a person far off."""
    vy = np.where((np.arange(40) >= 10) & (np.arange(40) < 13), 0.5, 0.0)
    vx = np.full(40, 0.5)
    pose = np.stack((0.05 * np.arange(40), np.concatenate(([0.0], np.cumsum(0.1 * vy[:-1]))), np.zeros(40)), axis=1)
    record = record_of(pose, twist=np.stack((vx, vy, 0 * vx), axis=1), **crowd(40, (1.5, 1.0, 0.0, 0.0)))
    assert np.isfinite(times_to_collision(record, 3.0)[10:13]).all()
    assert math.isnan(si["reaction_distance"](record))


def test_who_walks_into_a_standing_robot_demands_no_reaction(si, record_of):
    record = record_of(np.zeros((40, 3)), **crowd(40, (2.0, 0.0, -0.5, 0.0)), **touched(3.0, caused=False))
    assert math.isnan(si["reaction_distance"](record))


def test_reaction_is_the_mean_over_people(si, record_of):
    pose, twist = braking(20)
    record = record_of(pose, twist=twist, **crowd(40, (2.4, 0.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0), (9.0, 5.0, 0.0, 0.0)))
    assert si["reaction_distance"](record) == pytest.approx((0.9 + 0.5) / 2)


def test_a_box_is_touched_at_its_side_and_at_its_corner():
    u, r = np.array([[-1.0, 0.0]]), np.array([0.1])
    assert times_to_contact(BOX, np.array([[2.0, 0.1]]), u, r, 5.0) == pytest.approx([1.6])
    corner = 2.0 - 0.3 - math.sqrt(0.1**2 - 0.06**2)
    assert times_to_contact(BOX, np.array([[2.0, 0.26]]), u, r, 5.0) == pytest.approx([corner])
    assert np.isinf(times_to_contact(BOX, np.array([[2.0, 0.301]]), u, r, 5.0))


def test_who_slides_in_from_beside_the_box_touches_it_although_the_centres_part():
    found = times_to_contact(BOX, np.array([[0.05, 0.32]]), np.array([[0.5, -0.1]]), np.array([0.1]), 5.0)
    assert found == pytest.approx([0.2])


def test_who_touches_and_leaves_is_no_threat():
    there = np.array([[0.5, 0.0]])
    assert np.isinf(times_to_contact(DISC, there, np.array([[0.1, 0.0]]), np.array([0.31]), 5.0))
    assert times_to_contact(DISC, there, np.array([[-0.1, 0.0]]), np.array([0.31]), 5.0) == 0.0


def test_distances_from_a_box():
    points = np.array([[1.0, 0.0], [0.6, 0.6], [0.0, -0.5], [0.1, 0.1]])
    assert outline_distances(BOX, points) == pytest.approx([0.7, 0.5, 0.3, 0.0])
    assert outline_distances(DISC, points) == pytest.approx([0.8, math.hypot(0.6, 0.6) - 0.2, 0.3, 0.0])


def test_who_comes_nearer_too_slowly_for_a_number_never_touches():
    assert np.isinf(times_to_contact(BOX, np.array([[0.0, 2.0]]), np.array([[0.0, -2e-311]]), np.array([0.5]), 5.0))


places = st.tuples(*[st.floats(-3.0, 3.0)] * 2)
speeds = st.tuples(*[st.floats(-1.5, 1.5)] * 2)


@settings(derandomize=True, deadline=None, max_examples=200)
@given(st.sampled_from([DISC, BOX]), places, speeds, st.floats(0.05, 0.6))
def test_time_to_contact_is_when_small_steps_first_touch(footprint, place, speed, radius):
    offsets, velocities, radii = np.array([place]), np.array([speed]), np.array([radius])
    if outline_distances(footprint, offsets)[0] <= radius + 1e-6:
        return
    steps = np.linspace(0.0, 5.0, 5001)
    gaps = outline_distances(footprint, offsets + steps[:, None] * velocities) - radius
    found = times_to_contact(footprint, offsets, velocities, radii, 5.0)[0]
    if gaps.min() > 1e-3:
        assert found > 5.0
    elif gaps.min() < -1e-3:
        assert found == pytest.approx(steps[np.argmax(gaps <= 0.0)], abs=2e-3)


@settings(derandomize=True, deadline=None, max_examples=50)
@given(st.floats(-3.1, 3.1), st.floats(-40, 40), st.floats(-40, 40))
def test_turning_and_shifting_the_world_changes_no_course(si, record_of, turn, x, y):
    c, s = math.cos(turn), math.sin(turn)
    matrix = np.array([[c, s], [-s, c]])
    pose, twist = braking(20)
    people = crowd(40, (2.4, 0.3, -0.1, 0.0), (1.6, 2.2, 0.0, -0.6))
    moved = np.column_stack((pose[:, :2] @ matrix + (x, y), pose[:, 2] + turn))
    turned = people | {
        "pedestrian_positions": people["pedestrian_positions"] @ matrix + (x, y),
        "pedestrian_velocities": people["pedestrian_velocities"] @ matrix,
    }
    assert si["reaction_distance"](record_of(pose, twist=twist, **people)) > 0.0
    for name in ("time_to_collision_min", "reaction_distance"):
        assert si[name](record_of(moved, twist=twist, **turned)) == pytest.approx(
            si[name](record_of(pose, twist=twist, **people)), abs=1e-6
        )


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_any_crowd_gives_figures_within_their_bounds(si, record_of, seed):
    """A person who walks through the robot, jumps or leaves the world, while the robot does as it likes."""
    random = np.random.default_rng(seed)
    pose, twist = random.normal(0.0, [0.1, 0.1, 0.3], (80, 3)).cumsum(axis=0), random.normal(0.0, 0.5, (80, 3))
    places, speeds = random.normal(0.0, 2.0, (2, 80, 3, 2))
    places[random.random((80, 3)) < 0.1] = np.nan
    people = crowd(80, *[(0.0, 0.0, 0.0, 0.0)] * 3) | {"pedestrian_positions": places, "pedestrian_velocities": speeds}
    meta = {"robot": {"name": "box", "footprint": BOX}}
    for more in ({}, touched(4.0)):
        record = record_of(pose, twist=twist, meta=meta, **people, **more)
        assert 0.0 <= si["time_to_collision_min"](record) <= 3.0
        reacted = si["reaction_distance"](record)
        assert math.isnan(reacted) or reacted >= 0.0
