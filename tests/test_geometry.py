import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arena_core import ConfigurationError, Footprint, Pose, Twist, wrap_angle

metres = st.floats(-1e3, 1e3)
poses = st.builds(Pose, metres, metres, st.floats(-20.0, 20.0))


def close(one, other):
    return (
        math.hypot(one.x - other.x, one.y - other.y) < 1e-9 and abs(float(wrap_angle(one.theta - other.theta))) < 1e-9
    )


@given(angle=st.floats(-1e4, 1e4))
def test_wrapping_keeps_the_direction(angle):
    wrapped = float(wrap_angle(angle))
    assert -math.pi <= wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)


def test_half_a_turn_wraps_to_minus_pi():
    assert wrap_angle([math.pi, -math.pi, 3 * math.pi]).tolist() == pytest.approx([-math.pi] * 3)


@given(frame=poses, pose=poses)
def test_relative_undoes_compose(frame, pose):
    assert close(frame.relative(frame.compose(pose)), pose)


@given(frame=poses, pose=poses)
def test_compose_undoes_relative(frame, pose):
    assert close(frame.compose(frame.relative(pose)), pose)


@given(frame=poses, one=poses, other=poses)
def test_distances_do_not_depend_on_the_frame(frame, one, other):
    assert frame.relative(one).distance(frame.relative(other)) == pytest.approx(one.distance(other), abs=1e-9)


def test_a_step_ahead_from_a_robot_that_looks_left_goes_left():
    assert close(Pose(1.0, 2.0, math.pi / 2).compose(Pose(3.0, 0.0)), Pose(1.0, 5.0, math.pi / 2))


def test_arrays_and_values_are_two_forms_of_one_thing():
    assert Pose.of(Pose(1.0, 2.0, 3.0).array()) == Pose(1.0, 2.0, 3.0)
    assert Twist.of(Twist(1.0, 2.0, 3.0).array()) == Twist(1.0, 2.0, 3.0)


@pytest.mark.parametrize("radius", [0.0, -0.1, math.nan, math.inf])
def test_a_disc_needs_a_radius(radius):
    with pytest.raises(ConfigurationError, match=r"radius is .* allowed: a finite number > 0"):
        Footprint.circle(radius)


def test_a_disc_is_its_own_inscribed_circle():
    disc = Footprint.circle(0.3)
    assert disc.is_circle
    assert (disc.radius, disc.inscribed_radius) == (0.3, 0.3)


def test_radii_of_a_rectangle():
    box = Footprint.polygon([(-0.3, -0.2), (0.4, -0.2), (0.4, 0.2), (-0.3, 0.2)])
    assert not box.is_circle
    assert box.radius == pytest.approx(math.hypot(0.4, 0.2))
    assert box.inscribed_radius == pytest.approx(0.2)


@given(
    tenths=st.sets(st.integers(0, 62), min_size=3, max_size=9),
    radius=st.floats(0.1, 5.0),
    clockwise=st.booleans(),
)
def test_a_polygon_on_a_circle_turns_counter_clockwise_whatever_its_order(tenths, radius, clockwise):
    angles = np.sort([*tenths]) / 10
    if np.diff([*angles, angles[0] + 2 * math.pi]).max() > 3.0:
        return  # the centre lies outside
    vertices = radius * np.column_stack((np.cos(angles), np.sin(angles)))
    footprint = Footprint.polygon(vertices[::-1] if clockwise else vertices)
    x, y = footprint.vertices_xy.T
    assert np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) > 0.0
    assert footprint.radius == pytest.approx(radius)
    assert 0.0 < footprint.inscribed_radius < radius


@pytest.mark.parametrize(
    ("vertices", "reason"),
    [
        ([(0.0, 0.0), (1.0, 0.0)], "three or more"),
        ([(0.0, 0.0, 0.0)] * 4, "three or more"),
        ([(-1, -1), (1, -1), (0, 0.1), (1, 1), (-1, 1)], "convex"),
        ([(-1, -1), (1, -1), (1, -1), (1, 1), (-1, 1)], "convex"),
        ([(-1, -1), (0, -1), (1, -1), (1, 1), (-1, 1)], "convex"),
        ([(1, 1), (2, 1), (2, 2), (1, 2)], "contain the origin"),
    ],
)
def test_an_impossible_polygon_says_why(vertices, reason):
    with pytest.raises(ConfigurationError, match=reason):
        Footprint.polygon(vertices)


def test_a_star_is_no_footprint():
    angles = math.pi / 2 + np.arange(5) * 4 * math.pi / 5
    with pytest.raises(ConfigurationError, match="convex"):
        Footprint.polygon(np.column_stack((np.cos(angles), np.sin(angles))))
