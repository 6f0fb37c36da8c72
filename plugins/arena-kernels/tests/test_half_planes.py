import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from arena_kernels.half_planes import line_violation, put_bound, put_person, smallest_change

HORIZON, OVERLAP = 3.0, 0.5
POSITION, SPEED = st.floats(-4.0, 4.0), st.floats(-2.0, 2.0)


def collides(px, py, vx, vy, radius):
    """Return whether a disc at (px, py) is met within the horizon at a relative velocity (vx, vy)."""
    squared = vx * vx + vy * vy
    t = 0.0 if squared == 0.0 else min(max((px * vx + py * vy) / squared, 0.0), HORIZON)
    return math.hypot(px - vx * t, py - vy * t) < radius


@settings(derandomize=True, deadline=None, max_examples=150)
@given(POSITION, POSITION, SPEED, SPEED, st.floats(0.2, 1.0))
def test_changed_velocity_just_avoids_the_collision(px, py, vx, vy, radius):
    assume(math.hypot(px, py) > radius * 1.01)
    ux, uy, _, _ = smallest_change((px, py, vx, vy), radius, HORIZON, OVERLAP)
    assert not collides(px, py, vx + ux, vy + uy, radius - 1e-6)
    assert collides(px, py, vx + ux, vy + uy, radius + 1e-6)


@settings(derandomize=True, deadline=None, max_examples=100)
@given(
    st.floats(1.1, 4.0), st.floats(-math.pi, math.pi), st.floats(-0.95, 0.95), st.floats(0.2, 1.0), st.floats(1.0, 3.0)
)
def test_no_smaller_change_of_a_colliding_velocity_avoids_it(apart, bearing, aim, radius, haste):
    px, py = apart * math.cos(bearing), apart * math.sin(bearing)
    vx, vy = (
        haste * (px - aim * radius * math.sin(bearing)) / HORIZON,
        haste * (py + aim * radius * math.cos(bearing)) / HORIZON,
    )
    assert collides(px, py, vx, vy, radius)
    ux, uy, _, _ = smallest_change((px, py, vx, vy), radius, HORIZON, OVERLAP)
    size = 0.99 * math.hypot(ux, uy)
    for angle in np.linspace(0.0, 2.0 * math.pi, 73):
        assert collides(px, py, vx + size * math.cos(angle), vy + size * math.sin(angle), radius)


@settings(derandomize=True, deadline=None, max_examples=200)
@given(POSITION, POSITION, SPEED, SPEED, SPEED, SPEED, st.floats(0.2, 1.0), st.floats(-3.0, 3.0), st.floats(0.0, 2.0))
def test_velocity_on_the_allowed_side_never_collides_with_a_person_who_walks_on(
    px, py, vx, vy, ox, oy, radius, along, aside
):
    assume(math.hypot(px, py) > radius * 1.01)
    lines = np.empty((1, 4))
    put_person(lines, 0, (px, py, ox, oy), (vx, vy), radius, (HORIZON, OVERLAP, 1.0))
    qx, qy, ax, ay = lines[0]
    chosen = qx + along * ax - aside * ay, qy + along * ay + aside * ax
    assert line_violation(lines[0], *chosen) <= 1e-9
    assert not collides(px, py, chosen[0] - ox, chosen[1] - oy, radius - 1e-6)


def test_overlapping_discs_part_within_the_overlap_time():
    ux, uy, _, _ = smallest_change((0.3, 0.0, 0.0, 0.0), 0.5, HORIZON, OVERLAP)
    assert (0.3 - ux * OVERLAP, uy) == pytest.approx((0.5, 0.0))


def test_two_who_share_the_change_evenly_do_it_together():
    whole, half = np.empty((1, 4)), np.empty((1, 4))
    own, place = (0.5, 0.0), (2.0, 0.1, -0.5, 0.0)
    put_person(whole, 0, place, own, 0.5, (HORIZON, OVERLAP, 1.0))
    put_person(half, 0, place, own, 0.5, (HORIZON, OVERLAP, 0.5))
    assert half[0, :2] - own == pytest.approx(0.5 * (whole[0, :2] - own))
    assert half[0, 2:] == pytest.approx(whole[0, 2:])


def test_bound_holds_back_the_velocity_along_its_normal_only():
    lines = np.empty((1, 4))
    put_bound(lines, 0, 0.6, 0.8, 0.5)
    assert line_violation(lines[0], 0.3, 0.4) == pytest.approx(0.0)
    assert line_violation(lines[0], 0.6, 0.8) == pytest.approx(0.5)
    assert line_violation(lines[0], -8.0, 6.0) == pytest.approx(-0.5)
