import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import Pose
from arena_navigation.amcl.directions import PlacedParticles, wrap_angle, write_directions
from arena_navigation.amcl.draws import Draw
from arena_navigation.amcl.motion import Alphas, move_particles, odometry_motion

ALPHAS = Alphas(0.1, 0.02, 0.03, 0.004, 0.05)
EXACT = Alphas(0.0, 0.0, 0.0, 0.0, 0.0)
KEY = np.uint64(11)
metres = st.floats(-2.0, 2.0)
headings = st.floats(-3.14, 3.14)


def moved(displacement, model, alphas, start=(0.0, 0.0, 0.0), count=1):
    poses = np.repeat(np.array(start, float)[:, None], count, axis=1)
    move_particles(
        PlacedParticles(poses, np.empty((2, count)), count),
        odometry_motion(displacement, model, alphas),
        Draw(KEY, 3),
        np.empty(3 * count),
    )
    return poses


@pytest.mark.parametrize("model", ["diff", "omni", "diff-corrected", "omni-corrected"])
@settings(derandomize=True, deadline=None, max_examples=60)
@given(x=metres, y=metres, turn=headings, sx=metres, sy=metres, heading=headings)
def test_motion_without_noise_is_the_displacement(model, x, y, turn, sx, sy, heading):
    displacement, start = Pose(x, y, turn), Pose(sx, sy, heading)
    if math.hypot(x, y) < 0.01 and model.startswith("diff"):
        displacement = Pose(0.0, 0.0, turn)  # too short to have a direction
    reached = moved(displacement, model, EXACT, start.array())[:, 0]
    expected = start.compose(displacement)
    assert reached[:2] == pytest.approx((expected.x, expected.y), abs=1e-9)
    assert wrap_angle(reached[2] - expected.theta) == pytest.approx(0.0, abs=1e-9)


def test_differential_motion_has_the_variances_of_table_5_6():
    step = Pose(0.8, 0.3, 0.9)
    turn, travel = math.atan2(0.3, 0.8), math.hypot(0.8, 0.3)
    again = 0.9 - turn
    a1, a2, a3, a4, _ = ALPHAS
    x, y, theta = moved(step, "diff-corrected", ALPHAS, count=40_000)
    assert np.var(np.arctan2(y, x)) == pytest.approx(a1 * turn**2 + a2 * travel**2, rel=0.05)
    assert np.var(np.hypot(x, y)) == pytest.approx(a3 * travel**2 + a4 * (turn**2 + again**2), rel=0.05)
    assert np.var(theta) == pytest.approx(a1 * (turn**2 + again**2) + 2 * a2 * travel**2, rel=0.05)
    assert (np.mean(theta), np.mean(np.hypot(x, y))) == pytest.approx((0.9, travel), abs=0.01)


def test_omnidirectional_motion_has_the_variances_of_nav2():
    a1, a2, a3, a4, a5 = ALPHAS
    x, y, theta = moved(Pose(0.0, 0.7, 0.4), "omni-corrected", ALPHAS, count=40_000)
    assert np.var(y) == pytest.approx(a3 * 0.7**2 + a4 * 0.4**2, rel=0.05)
    assert np.var(x) == pytest.approx(a4 * 0.4**2 + a5 * 0.7**2, rel=0.05)
    assert np.var(theta) == pytest.approx(a1 * 0.4**2 + a2 * 0.7**2, rel=0.05)
    assert (np.mean(x), np.mean(y), np.mean(theta)) == pytest.approx((0.0, 0.7, 0.4), abs=0.01)


def test_models_that_are_not_corrected_take_the_variance_for_the_deviation():
    step = Pose(0.5, 0.1, 0.3)
    plain, corrected = odometry_motion(step, "diff", ALPHAS), odometry_motion(step, "diff-corrected", ALPHAS)
    assert plain[:3] == corrected[:3]
    assert plain[3:] == pytest.approx(np.square(corrected[3:]))


def test_omni_that_is_not_corrected_has_two_alphas_the_wrong_way_round():
    step = Pose(0.5, 0.1, 0.3)
    swapped = ALPHAS._replace(
        rotation_from_rotation=ALPHAS.translation_from_rotation, translation_from_rotation=ALPHAS.rotation_from_rotation
    )
    plain, corrected = odometry_motion(step, "omni", ALPHAS), odometry_motion(step, "omni-corrected", swapped)
    assert plain[3:] == pytest.approx(np.square(corrected[3:]))


def test_driving_backwards_is_as_noisy_as_forwards():
    forwards, backwards = (odometry_motion(Pose(x, 0.0, 0.0), "diff-corrected", ALPHAS) for x in (0.5, -0.5))
    assert backwards[3:] == pytest.approx(forwards[3:])
    assert abs(backwards.turn) == pytest.approx(math.pi)


def test_turning_on_the_spot_has_no_direction_of_travel():
    step = odometry_motion(Pose(0.003, 0.004, 0.6), "diff-corrected", ALPHAS)
    assert (step.turn, step.turn_again) == (0.0, 0.6)


@settings(derandomize=True, deadline=None)
@given(st.lists(st.floats(-20.0, 20.0), min_size=1, max_size=40))
def test_directions_are_cosine_and_sine_to_rounding(angles):
    angles = np.array(angles)
    directions = np.empty((2, len(angles)))
    write_directions(angles, len(angles), directions)
    np.testing.assert_allclose(directions, (np.cos(angles), np.sin(angles)), rtol=0.0, atol=5e-16)


@settings(derandomize=True, deadline=None)
@given(st.floats(-50.0, 50.0))
def test_wrapped_angle_points_the_same_way(angle):
    assert -math.pi <= wrap_angle(angle) <= math.pi
    assert math.cos(wrap_angle(angle)) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrap_angle(angle)) == pytest.approx(math.sin(angle), abs=1e-9)


def test_draws_depend_on_key_and_tick_alone():
    def drawn(key, tick):
        poses = np.zeros((3, 50))
        move_particles(
            PlacedParticles(poses, np.empty((2, 50)), 50),
            odometry_motion(Pose(0.5, 0.0, 0.2), "diff-corrected", ALPHAS),
            Draw(np.uint64(key), tick),
            np.empty(150),
        )
        return poses

    np.testing.assert_array_equal(drawn(1, 1), drawn(1, 1))
    assert not np.any(drawn(1, 1) == drawn(1, 2))
    assert not np.any(drawn(1, 1) == drawn(2, 1))
