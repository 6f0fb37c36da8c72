"""How a robot moved, on paths whose figures can be worked out by hand."""

import math

import numpy as np
import pytest

from arena_metrics.packs import motion, proximity
from arena_metrics.packs.collision_courses import time_to_collision_min, times_to_collision
from arena_metrics.packs.footprints import outline_distances, times_to_contact


def at(*xs):
    return np.column_stack((xs, np.zeros(len(xs)), np.zeros(len(xs))))


@pytest.mark.parametrize(
    ("xs", "longest"),
    [
        ((0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0), 2.5),
        ((0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 2.0), 2.5),
        ((0.0, 0.3, 0.0, 0.3, 0.5, 0.8, 0.6, 1.1), 2.0),
        ((0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2), 1.5),
        ((0.0, 1.0, 1.1, 1.2, 1.1), 1.5),
    ],
)
def test_a_stand_begins_anew_where_the_robot_left_the_circle_of_the_one_before(record_of, xs, longest):
    """Circles of 0.5 m, a row each half second."""
    assert motion.longest_stand(record_of(at(*xs), 0.5), 0.5) == pytest.approx(longest)


def test_length_and_mean_speed(record_of):
    poses = [(0.0, 0.0, 0.0), (3.0, 4.0, 0.0), (3.0, 2.0, 0.0)]
    record = record_of(poses, 0.5)
    assert motion.path_length(record) == 7.0
    assert motion.mean_speed(record) == 7.0
    assert math.isnan(motion.mean_speed(record_of(poses[:1])))


def test_the_share_of_time_backwards_is_trapezoidal(record_of):
    speeds = np.array([(0.5, 0.0, 0.0), (-0.2, 0.0, 0.0), (-0.2, 0.0, 0.0), (-0.1, 0.0, 0.0), (0.0, 0.0, 0.0)])
    record = record_of(at(*range(5)), 0.5, twist=speeds)
    assert motion.reverse_share(record, 0.1) == pytest.approx((0.25 + 0.5 + 0.25) / 2.0)
    assert math.isnan(motion.reverse_share(record_of(at(0.0)), 0.1))


def test_acceleration_and_jerk_are_mean_magnitudes_of_difference_quotients(record_of):
    """Headed along y with 0, 1, 3 and 4 m/s ahead, every half second: 2, 4, 2 m/s^2; 4 and -4 m/s^3."""
    twist = np.column_stack(((0.0, 1.0, 3.0, 4.0), np.zeros(4), np.zeros(4)))
    poses = np.column_stack((np.zeros(4), np.zeros(4), np.full(4, 0.5 * math.pi)))
    record = record_of(poses, 0.5, twist=twist)
    assert motion.mean_acceleration(record, 0.5) == pytest.approx(8.0 / 3.0)
    assert motion.mean_jerk(record, 0.5) == pytest.approx(4.0)
    assert motion.mean_acceleration(record, 0.75) == pytest.approx((2.0 / 0.75 + 2.0 / 0.75) / 2.0), "between the rows"
    assert math.isnan(motion.mean_jerk(record_of(poses[:2], 0.5), 0.5))


def test_jerk_without_contact_leaves_out_what_touches_it(record_of):
    twist = np.column_stack(((0.0, 1.0, 3.0, 4.0, 9.0, 2.0), np.zeros(6), np.zeros(6)))
    contact = np.array((0.0, 0.0, 0.0, 0.0, 0.2, 0.0))  # between rows 3 and 4
    record = record_of(at(*np.zeros(6)), 0.5, twist=twist, contact_time=contact)
    assert motion.jerk_without_contact(record, 0.5) == pytest.approx((4.0 + 4.0) / 2.0), "rows 0 to 3"
    touched = motion.contact_spans(record, np.array((0.0, 1.0, 1.5, 2.0)), np.array((1.5, 2.0, 1.6, 2.5)))
    assert touched.tolist() == [False, True, True, False]
    assert math.isnan(motion.jerk_without_contact(record_of(at(*np.zeros(6)), 0.5, contact_time=np.ones(6)), 0.5))


def test_a_circle_has_the_curvature_of_its_radius_and_a_reversal_the_greatest(record_of):
    angle = np.linspace(0.0, 3.0, 301)
    circle = np.column_stack((2.0 * np.cos(angle), 2.0 * np.sin(angle), angle))
    record = record_of(circle)
    for found in (motion.curvature_mean, motion.curvature_max, motion.curvature_min):
        assert found(record, 0.2) == pytest.approx(0.5, rel=1e-3)
    assert motion.curvature_normalised(record, 0.2) == pytest.approx(0.5 * 0.4, rel=1e-2)
    assert motion.angle_over_length(record, 0.2) == pytest.approx(0.5, rel=1e-3)
    back = record_of(at(0.0, 0.2, 0.4, 0.2, 0.0))
    assert motion.curvature_max(back, 0.2) == pytest.approx(2.0 / 0.2)
    assert motion.curvature_min(back, 0.2) == 0.0
    assert math.isnan(motion.curvature_mean(record_of(at(0.0, 0.3)), 0.2))
    assert math.isnan(motion.angle_over_length(record_of(at(0.0, 0.3)), 0.2))


def test_roughness_is_height_over_base_and_1_at_most(record_of):
    """A right angle between two sides of 1 m: the height is half of its base, the root of 2."""
    corner = record_of([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0)])
    assert motion.path_roughness(corner, 1.0) == pytest.approx(0.5)
    assert motion.path_roughness(record_of(at(0.0, 1.0, 0.0)), 1.0) == 1.0
    assert motion.path_roughness(record_of(at(0.0, 1.0, 2.0)), 1.0) == 0.0


def test_points_lie_a_step_apart_along_the_path():
    corner = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (1.0, 1.0)])
    found = motion.resample_by_length(corner, 0.75)
    assert found.ravel() == pytest.approx((0.0, 0.0, 0.75, 0.0, 1.0, 0.5))


def test_clearances_are_over_what_is_finite_and_in_radii(record_of):
    record = record_of(at(*range(4)), clearance=np.array((0.2, np.inf, 1.0, 0.6)))
    assert proximity.clearance_mean(record) == pytest.approx(0.6)
    assert (proximity.clearance_min(record), proximity.clearance_max(record)) == (0.2, 1.0)
    assert proximity.clearance_normalised(record) == pytest.approx(3.0)


def test_personal_space_is_trapezoidal_and_encounters_are_rising_edges(record_of):
    near = np.array((0.4, 0.6, 0.4, 0.3, 0.5, 0.2))
    record = record_of(at(*range(6)), 0.5, clearance_people=near)
    assert proximity.personal_space_time(record, 0.5) == pytest.approx(0.25 + 0.25 + 0.5 + 0.25 + 0.25)
    assert proximity.encounter_count(record, 0.5) == 3.0


def person(record_of, x, y, vx, vy, **given):
    """Return a record of a robot that drives along x with 0.5 m/s among one person at rest in its rows."""
    steps = 3
    return record_of(
        at(0.0, 0.5, 1.0),
        1.0,
        pedestrian_positions=np.tile(np.array((x, y)), (steps, 1, 1)),
        pedestrian_velocities=np.tile(np.array((vx, vy)), (steps, 1, 1)),
        **given,
    )


def test_a_collision_comes_when_both_discs_meet(record_of):
    """0.5 m of radii, 0.5 and 0.3 m/s against each other: 4 m less 0.5 m over 0.8 m/s."""
    record = person(record_of, 4.0, 0.0, -0.3, 0.0)
    assert times_to_collision(record, 9.0)[:, 0] == pytest.approx([3.5 / 0.8, 3.0 / 0.8, 2.5 / 0.8])
    assert time_to_collision_min(record, 9.0) == pytest.approx(2.5 / 0.8)
    assert time_to_collision_min(record, 2.0) == 2.0
    aside = person(record_of, 4.0, 0.3, -0.3, 0.0)
    assert times_to_collision(aside, 9.0)[0, 0] == pytest.approx((4.0 - 0.4) / 0.8)
    assert np.isinf(times_to_collision(person(record_of, 4.0, 0.51, -0.3, 0.0), 9.0)).all()
    assert np.isinf(times_to_collision(person(record_of, -4.0, 0.0, -0.3, 0.0), 9.0)).all()


SQUARE = {"radius": math.hypot(0.5, 0.2), "vertices_xy": [(0.5, -0.2), (0.5, 0.2), (-0.5, 0.2), (-0.5, -0.2)]}


@pytest.mark.parametrize(
    ("offset", "velocity", "time"),
    [
        ((2.0, 0.0), (-1.0, 0.0), 1.2),
        ((0.0, 2.0), (0.0, -0.5), 3.0),
        ((2.0, 0.44), (-1.0, 0.0), 2.0 - 0.5 - math.sqrt(0.3**2 - 0.24**2)),
        ((2.0, 0.51), (-1.0, 0.0), math.inf),
        ((2.0, 0.0), (1.0, 0.0), math.inf),
        ((0.7, 0.0), (-1.0, 0.0), 0.0),
        ((-2.0, 0.05), (0.5, 0.05), 2.4),
        ((0.7, 0.0), (1.0, 0.0), math.inf),
    ],
)
def test_a_disc_meets_a_side_or_a_corner_of_a_polygon(offset, velocity, time):
    found = times_to_contact(SQUARE, np.array([offset]), np.array([velocity]), np.array((0.3,)), 9.0)
    assert found[0] == pytest.approx(time)


def test_a_disc_that_overlaps_and_comes_no_nearer_meets_nothing():
    round_one = {"radius": 0.5, "vertices_xy": []}
    offsets, along = np.array([(0.3, 0.0), (0.3, 0.0)]), np.array([(0.0, 1.0), (-0.1, 1.0)])
    found = times_to_contact(round_one, offsets, along, np.array((0.3, 0.3)), 9.0)
    assert found.tolist() == [math.inf, 0.0]


def test_the_distance_from_a_polygon_is_to_its_nearest_side_or_corner():
    points = np.array([(1.0, 0.1), (0.8, 0.6), (0.0, -0.5), (0.1, 0.1)])
    assert outline_distances(SQUARE, points) == pytest.approx((0.5, 0.5, 0.3, 0.0))
    disc = {"radius": 0.5, "vertices_xy": []}
    assert outline_distances(disc, np.array([(0.6, 0.8), (0.1, 0.1)])) == pytest.approx((0.5, 0.0))
