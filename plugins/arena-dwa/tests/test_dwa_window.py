import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_dwa.settings import Limits
from arena_dwa.window import REST, axis_samples, dynamic_window, is_drivable, turn_samples

LIMITS = Limits(-0.3, 0.8, 0.4, 1.5, 0.0, 0.8, 0.0, 1.0, 0.7, 2.0, 0.0)
SPEED = st.floats(-5.0, 5.0)


@settings(derandomize=True, deadline=None)
@given(SPEED, SPEED, SPEED, st.floats(0.01, 1.0))
def test_window_respects_limits_and_accelerations(vx, vy, wz, period):
    window = dynamic_window(np.array((vx, vy, wz)), LIMITS, period)
    lows, highs = np.array((-0.3, -0.4, -1.5)), np.array((0.8, 0.4, 1.5))
    accelerations = np.array((1.0, 0.7, 2.0))
    excess = max(1.0, math.hypot(vx, vy) / LIMITS.trans_max)
    inside = np.clip((vx / excess, vy / excess, wz), lows, highs)
    assert (window[:, 0] <= window[:, 1]).all()
    assert (window[:, 0] >= lows).all()
    assert (window[:, 1] <= highs).all()
    assert (np.abs(window - inside[:, None]) <= accelerations[:, None] * period + 1e-12).all()


def test_robot_measured_too_fast_has_samples_that_are_driven():
    limits = LIMITS._replace(vx_max=2.78, vy_max=2.78, trans_max=2.78, ax_max=2.5, ay_max=2.5)
    window = dynamic_window(np.array((2.02, 2.72, 0.0)), limits, 0.1)
    assert is_drivable(window[0, 0], window[1, 0], 0.0, limits)


@settings(derandomize=True, deadline=None)
@given(st.floats(-3.0, 3.0), st.floats(0.0, 3.0), st.integers(0, 40))
def test_samples_span_the_window_and_include_rest_where_it_lies_inside(low, width, count):
    samples = axis_samples(low, low + width, count)
    assert (np.diff(samples) > 0.0).all()
    assert samples[0] >= low - REST
    assert samples[-1] <= low + width + 1e-12
    assert len(samples) <= max(count, 1) + 1
    if low <= 0.0 <= low + width:
        assert 0.0 in samples
    if count >= 2 and width > 1e-9:
        assert math.isclose(samples[0], low, abs_tol=1e-9)
        assert math.isclose(samples[-1], low + width, abs_tol=1e-9)


def test_symmetric_window_has_symmetric_samples():
    samples = axis_samples(-2.84, 2.84, 40)
    assert len(samples) == 41
    np.testing.assert_allclose(samples, -samples[::-1], atol=1e-12)


def test_slow_samples_are_dropped_only_if_they_also_turn_slowly():
    limits = LIMITS._replace(trans_min=0.11, theta_min=1.37)
    assert not is_drivable(0.0, 0.0, 0.0, limits)
    assert not is_drivable(0.1, 0.0, 1.0, limits)
    assert is_drivable(0.1, 0.0, 1.4, limits)
    assert is_drivable(0.11, 0.0, 0.0, limits)


def test_diagonal_speed_is_limited():
    assert is_drivable(0.5, 0.5, 0.0, LIMITS)
    assert not is_drivable(0.7, 0.7, 0.0, LIMITS)


@settings(derandomize=True, deadline=None)
@given(st.floats(-2.0, 2.0), st.floats(-4.0, 4.0), st.floats(0.0, 4.0))
def test_steered_samples_never_turn_tighter_than_the_wheels_allow(vx, low, width):
    limits = LIMITS._replace(turn_radius=0.48)
    window = np.array(((-2.0, 2.0), (0.0, 0.0), (low, min(low + width, 4.0))))
    window[2].sort()
    assert (np.abs(turn_samples(vx, window, limits, 21)) <= abs(vx) / 0.48 + 1e-9).all()
