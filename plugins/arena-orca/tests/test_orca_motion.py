import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import Costmap, Pose
from arena_kernels.costmap_window import CostmapWindow, outline_of
from arena_kernels.distance import distance_field
from arena_kernels.half_planes import line_violation
from arena_orca.braking import can_stop, least_gap
from arena_orca.escape import StuckDetector
from arena_orca.free_space import put_walls
from arena_orca.gear_changes import GearSelector
from arena_orca.motion import centre_velocity, command_for, put_reach
from arena_orca.parameters import (
    ACKERMANN,
    DIFFERENTIAL,
    OMNIDIRECTIONAL,
    Body,
    DriveRules,
    Limits,
    PersonRules,
    Settings,
    StaticRules,
)
from arena_orca.step import stoppable_command

AHEAD = 0.1
LIMITS = Limits(-0.5, 1.0, 0.8, 2.0, 2.5, 2.5, 5.0, 0.5)
DISC = outline_of(None, 0.2, 0.2, 0.05)
OPEN = CostmapWindow(np.zeros((40, 40), np.uint8), np.full((40, 40), np.inf, np.float32), 0.05, -1.0, -1.0)
KINDS = st.sampled_from([OMNIDIRECTIONAL, DIFFERENTIAL, ACKERMANN])
SHARE = st.floats(-1.0, 1.0)


def body_of(kind):
    ahead = 0.0 if kind == OMNIDIRECTIONAL else AHEAD
    return Body(kind, ahead, 0.2 + ahead, math.hypot(0.2, ahead))


def reachable(kind, now, x, y, time):
    """Tell from the limits themselves whether the effective centre can have velocity (x, y) ``time`` s from ``now``."""
    side, change = (
        (LIMITS.vy_max, LIMITS.ay_max) if kind == OMNIDIRECTIONAL else (AHEAD * LIMITS.wz_max, AHEAD * LIMITS.alpha_max)
    )
    fits = LIMITS.vx_min <= x <= LIMITS.vx_max and abs(y) <= side
    fits = fits and abs(x - now[0]) <= LIMITS.ax_max * time and abs(y - now[1]) <= change * time
    return fits and (kind != ACKERMANN or (x >= 0.0 and abs(y) * LIMITS.turn_radius <= AHEAD * x))


@settings(derandomize=True, deadline=None, max_examples=300)
@given(KINDS, SHARE, SHARE, SHARE, SHARE)
def test_reach_holds_exactly_what_limits_and_accelerations_allow(kind, forward, turn, x, y):
    body = body_of(kind)
    now = centre_velocity(body, LIMITS, forward * 1.2, turn, 2.5 * turn)
    lines = np.empty((6, 4))
    count = put_reach(lines, 0, body, LIMITS, now, 0.1, 1.0)
    worst = max(line_violation(line, 1.2 * x, y) for line in lines[:count])
    if abs(worst) > 1e-9:
        assert (worst < 0.0) == reachable(kind, now, 1.2 * x, y, 0.1)


@settings(derandomize=True, deadline=None)
@given(KINDS, SHARE, SHARE, SHARE, SHARE)
def test_command_is_reachable_in_one_period_and_steers_no_tighter_than_the_wheels_can(kind, forward, turn, x, y):
    twist = (0.7 * forward, turn if kind == OMNIDIRECTIONAL else 0.0, 2.0 * turn)
    vx, vy, wz = command_for(body_of(kind), LIMITS, twist, (x, y), 0.1)
    assert abs(vx - twist[0]) <= 0.25 + 1e-9
    assert abs(vy - twist[1]) <= 0.25 + 1e-9
    if kind == ACKERMANN:
        assert abs(wz) <= abs(vx) / LIMITS.turn_radius + 1e-9
    else:
        assert abs(wz - twist[2]) <= 0.5 + 1e-9


def test_wished_velocity_that_is_within_reach_is_driven():
    vx, _, wz = command_for(body_of(DIFFERENTIAL), LIMITS, (0.5, 0.0, 0.0), (0.6, 0.03), 0.1)
    assert (vx, AHEAD * wz) == pytest.approx((0.6, 0.03))


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.lists(st.tuples(st.integers(40, 79), st.integers(40, 79)), min_size=5, max_size=30), SHARE, SHARE)
def test_velocities_that_walls_allow_keep_the_robot_clear_for_the_horizon(cells, x, y):
    lethal = np.zeros((120, 120), np.bool_)
    for row, column in cells:
        if math.hypot(row - 59.5, column - 59.5) > 8.0:
            lethal[row, column] = True
    window = CostmapWindow(np.where(lethal, 254, 0).astype(np.uint8), distance_field(lethal, 0.05), 0.05, -3.0, -3.0)
    lines, body = np.empty((12, 4)), body_of(OMNIDIRECTIONAL)
    rules = StaticRules(0.5, 0.05, 0.02, 0.5)
    count = put_walls(lines, 0, window, DISC, body, rules, (0.0, 0.0, 1.0, 0.0), 1.5, np.empty((4096, 3)))
    if count < 12 and all(line_violation(line, x, y) <= 0.0 for line in lines[:count]):
        rows, columns = np.nonzero(lethal)
        places = np.column_stack((columns, rows)) * 0.05 - 2.975
        for t in np.linspace(0.0, 0.5, 11):
            assert not len(places) or np.hypot(*(places - (x * t, y * t)).T).min() > 0.2 + 0.05 + 0.02


def test_braking_path_of_a_fast_robot_is_longer_than_that_of_a_slow_one():
    costmap = Costmap(*_walled(0.6), 0.05, np.array((-1.0, -1.0)))
    window = CostmapWindow(costmap.costs, costmap.distance, 0.05, -1.0, -1.0)
    for speed, free in ((1.0, True), (1.5, False)):
        command, limits = (speed, 0.0, 0.0), LIMITS._replace(vx_max=2.0)
        assert can_stop(window, DISC, limits, (0.0, 0.0, 1.0, 0.0), command, command, 0.1, 0.02) == free


def _walled(x):
    lethal = np.zeros((40, 40), np.bool_)
    lethal[:, round((x + 1.0) / 0.05) :] = True
    return np.where(lethal, 254, 0).astype(np.uint8), distance_field(lethal, 0.05)


def test_gap_to_a_walking_person_is_that_of_the_nearest_moment():
    person = np.array(((1.0, 0.0, -1.0, 0.0, 0.3),))
    stand, rest = (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0)
    assert least_gap(person, DISC, LIMITS, stand, rest, rest, (0.1, 0.3), 1.0) == pytest.approx(1.0 - 0.5 - 0.3)
    box = outline_of(np.array(((0.2, 0.1), (-0.2, 0.1), (-0.2, -0.1), (0.2, -0.1))), math.hypot(0.2, 0.1), 0.1, 0.01)
    assert least_gap(person, box, LIMITS, stand, rest, rest, (0.1, 0.3), 1.0) == pytest.approx(
        1.0 - 0.5 - 0.3, abs=0.001
    )


def test_velocity_that_could_not_be_braked_before_a_person_is_driven_more_slowly():
    settings_ = Settings(
        body_of(OMNIDIRECTIONAL),
        LIMITS._replace(vx_max=2.0),
        PersonRules(3.0, 1.0, 0.1, 0.5, 10),
        StaticRules(0.5, 0.02, 0.02, 0.5),
        DriveRules(0.5, 1.0, 0.4, 0.5, 0.1),
    )
    stand, twist, best = (0.0, 0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (1.5, 0.0)
    far, near = np.array(((5.0, 0.0, 0.0, 0.0, 0.3),)), np.array(((0.85, 0.0, 0.0, 0.0, 0.3),))
    assert stoppable_command(OPEN, DISC, far, settings_, stand, twist, best)[1] > 1.0
    assert stoppable_command(OPEN, DISC, near, settings_, stand, twist, best)[1] < 1.0


def test_car_backs_up_until_it_has_room_and_other_robots_never_change_gear():
    gears = GearSelector(0.5, reversible=True)
    assert gears.gear_order(Pose(0.0, 0.0)) == (1.0, -1.0)
    assert not gears.accept_command(Pose(0.0, 0.0), 1.0, 0.0, now=0.0)
    assert gears.accept_command(Pose(0.0, 0.0), -1.0, -0.3, now=0.0)
    assert gears.gear_order(Pose(-0.3, 0.0)) == (-1.0, 1.0)
    assert gears.gear_order(Pose(-0.6, 0.0)) == (1.0, -1.0)
    assert GearSelector(0.5, reversible=False).gear_order(Pose(0.0, 0.0)) == (1.0,)


def test_car_that_backs_up_changes_gear_although_it_cannot_stop_within_a_step():
    gears = GearSelector(0.5, reversible=True)
    assert gears.accept_command(Pose(0.0, 0.0), -1.0, -0.5, now=-0.3)
    assert gears.gear_order(Pose(-0.6, 0.0)) == (1.0, -1.0)
    assert gears.accept_command(Pose(-0.6, 0.0), 1.0, -0.3, now=-0.5)  # it brakes
    assert not gears.accept_command(Pose(-0.6, 0.0), 1.0, -0.5, now=-0.5)


def test_patience_ends_only_for_a_robot_that_gets_nowhere():
    patience = StuckDetector(1.0, 0.5)
    moving = [patience.is_stuck(0.1 * k, Pose(0.02 * k, 0.0)) for k in range(40)]
    assert not any(moving)
    patience.clear()
    standing = [patience.is_stuck(0.1 * k, Pose(0.0, 0.0)) for k in range(40)]
    assert standing.index(True) in (10, 11)
    assert not all(standing[10:])
    assert not any(StuckDetector(None, 0.5).is_stuck(0.1 * k, Pose(0.0, 0.0)) for k in range(40))
