"""Legs stay within the body, keep step with the way and not with the clock, and stand side by side."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_kernels.compiled import compiled
from arena_kernels.legs import STANDING, Gait, legs_of, smooth_velocity, step_length

GAIT = Gait(0.05, 0.17, 0.11, 1.34, 0.0065, 0.75, 0.3)
EXACT = settings(derandomize=True, deadline=None, max_examples=200)


@compiled
def legs(gait: Gait, radius: float, vx: float, vy: float, steps: float) -> Any:
    return legs_of(gait, 0.0, 0.0, radius, (vx, vy), steps)


@compiled
def settled(gait: Gait, vx: float, vy: float, wanted_x: float, wanted_y: float, dt: float) -> Any:
    return smooth_velocity(gait, (vx, vy), (wanted_x, wanted_y), dt)


@compiled
def length(gait: Gait, pace: float) -> Any:
    return step_length(gait, pace)


@EXACT
@given(st.floats(0.1, 0.9), st.floats(1e-4, 3.0), st.floats(-math.pi, math.pi), st.floats(0.0, 1e4))
def test_legs_are_within_the_body_and_opposite_each_other(
    radius: float, pace: float, heading: float, steps: float
) -> None:
    left_x, left_y, right_x, right_y, leg = legs(
        GAIT, radius, pace * math.cos(heading), pace * math.sin(heading), steps
    )
    assert (left_x, left_y) == (-right_x, -right_y)
    assert math.hypot(left_x, left_y) + leg <= radius + 1e-9
    assert 0.0 < leg <= 0.05
    if radius >= 0.25:
        assert math.hypot(left_x - right_x, left_y - right_y) >= 2.0 * leg  # they do not overlap


def test_who_stands_has_the_legs_side_by_side_and_who_walks_has_them_apart() -> None:
    left_x, left_y, right_x, right_y, _ = legs(GAIT, 0.3, STANDING, 0.0, 0.0)
    assert abs(left_x - right_x) < 0.01
    assert left_y - right_y == pytest.approx(0.17, abs=1e-4)
    left_x, left_y, right_x, right_y, _ = legs(GAIT, 0.3, 1.0, 0.0, 0.0)
    assert left_x - right_x == pytest.approx(0.75 * length(GAIT, 1.0))
    assert left_y - right_y == pytest.approx(0.17 - 0.06 / 1.34)


def test_legs_change_places_with_each_step_and_pass_each_other_between() -> None:
    front, half, behind, again = (legs(GAIT, 0.3, 0.0, 1.2, steps)[1] for steps in (4.0, 4.5, 5.0, 6.0))
    assert front == pytest.approx(-behind)
    assert front == pytest.approx(again)
    assert half == pytest.approx(0.0, abs=1e-12)


def test_steps_get_longer_and_quicker_with_speed() -> None:
    # Weidmann 1993, Sekiya and Nagasaki 1998: 0.7 m, 1.9 steps a second
    assert length(GAIT, 1.34) == pytest.approx(0.72, abs=0.01)
    paces = np.array((0.3, 0.6, 1.0, 1.34, 1.8))
    lengths = np.array([length(GAIT, pace) for pace in paces])
    assert (np.diff(lengths) > 0.0).all()
    assert (np.diff(paces / lengths) > 0.0).all()


def test_legs_take_up_a_velocity_in_their_time_and_keep_the_direction_of_who_stops() -> None:
    vx, vy = settled(GAIT, STANDING, 0.0, 0.0, 1.0, 0.3)
    assert math.hypot(vx, vy) == pytest.approx(1.0 - math.exp(-1.0), abs=1e-3)
    for _ in range(1000):
        vx, vy = settled(GAIT, vx, vy, 0.0, 0.0, 0.1)
    assert math.hypot(vx, vy) == pytest.approx(STANDING, rel=0.35)
    assert math.atan2(vy, vx) == pytest.approx(math.pi / 2, abs=1e-3)
