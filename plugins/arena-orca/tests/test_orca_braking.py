"""How a robot moves while it brakes, and how near it comes to people meanwhile, worked out by hand."""

import math

import numpy as np
import pytest

from arena_kernels.costmap_window import outline_of
from arena_orca.braking import LAPSE, gap_to_person, least_gap, next_pose, next_twist, pose_after, stopping_time
from arena_orca.parameters import Limits

NAMES = Limits._fields
LIMITS = Limits(**(dict.fromkeys(NAMES, 1.0) | {"ax_max": 2.0, "ay_max": 1.0, "alpha_max": 4.0, "turn_radius": 0.0}))
CAR = LIMITS._replace(turn_radius=0.5)
DISC = outline_of(None, 0.2, 0.2, 0.05)
BOX = outline_of(np.array([(0.4, -0.2), (0.4, 0.2), (-0.4, 0.2), (-0.4, -0.2)]), math.hypot(0.4, 0.2), 0.2, 0.05)


def test_every_axis_goes_to_its_command_within_its_acceleration():
    assert next_twist(LIMITS, (0.5, 0.0, -0.5), (0.0, 0.5, 0.5)) == pytest.approx((0.46, 0.02, -0.42))
    assert next_twist(LIMITS, (0.5, 0.0, -0.5), (0.47, 0.01, -0.5)) == pytest.approx((0.47, 0.01, -0.5))


def test_a_car_that_brakes_keeps_its_bend_and_one_that_drives_does_not():
    vx, vy, wz = next_twist(CAR, (0.5, 0.0, 0.8), (0.0, 0.0, 0.0))
    assert (vx, vy, wz / vx) == pytest.approx((0.46, 0.0, 0.8 / 0.5))
    assert next_twist(CAR, (0.0, 0.0, 0.8), (0.0, 0.0, 0.0)) == (0.0, 0.0, 0.0)
    assert next_twist(CAR, (0.5, 0.0, 0.8), (0.6, 0.0, 0.0)) == pytest.approx((0.54, 0.0, 0.72))
    assert next_twist(LIMITS, (0.5, 0.0, 0.8), (0.0, 0.0, 0.0)) == pytest.approx((0.46, 0.0, 0.72))


def test_a_step_goes_along_the_heading_half_way_through_its_turn():
    x, y, cosine, sine = next_pose((1.0, 2.0, math.cos(0.3), math.sin(0.3)), (0.5, 0.2, 5.0))
    middle, end = 0.3 + 2.5 * LAPSE, 0.3 + 5.0 * LAPSE
    assert x == pytest.approx(1.0 + LAPSE * (0.5 * math.cos(middle) - 0.2 * math.sin(middle)))
    assert y == pytest.approx(2.0 + LAPSE * (0.5 * math.sin(middle) + 0.2 * math.cos(middle)))
    assert (cosine, sine) == pytest.approx((math.cos(end), math.sin(end)))


def test_a_command_held_leads_along_its_arc():
    x, y, cosine, sine = pose_after(LIMITS, (0.0, 0.0, 1.0, 0.0), (0.5, 0.0, 0.5), (0.5, 0.0, 0.5), 1.0)
    assert (x, y) == pytest.approx((math.sin(0.5), 1.0 - math.cos(0.5)), rel=1e-3)
    assert (cosine, sine) == pytest.approx((math.cos(0.5), math.sin(0.5)))


def test_braking_takes_as_long_as_the_slowest_axis():
    assert stopping_time(LIMITS, (-0.5, 0.0, 0.4)) == 0.25
    assert stopping_time(LIMITS, (0.5, 0.0, -2.0)) == 0.5
    assert stopping_time(LIMITS, (0.5, -0.75, 2.0)) == 0.75
    assert stopping_time(LIMITS._replace(ay_max=0.0), (0.5, 9.0, 0.4)) == 0.25


def test_the_gap_to_a_person_is_that_of_the_footprint():
    turned = (1.0, 2.0, 0.0, 1.0)
    assert gap_to_person(DISC, turned, 1.6, 2.8, 0.3, 9.0) == pytest.approx(0.5)
    assert gap_to_person(BOX, turned, 1.7, 2.0, 0.3, 9.0) == pytest.approx(0.2, abs=1e-3), "beside its side"
    assert gap_to_person(BOX, turned, 1.0, 3.0, 0.3, 9.0) == pytest.approx(0.3, abs=1e-3), "before its front"
    assert gap_to_person(BOX, turned, 1.0, 2.1, 0.3, 9.0) < 0.0
    assert gap_to_person(BOX, turned, 9.0, 2.0, 0.3, 0.5) == pytest.approx(8.0 - 0.3 - math.hypot(0.4, 0.2))


def test_people_walk_on_while_a_robot_brakes():
    """At 0.5 m/s for 0.4 s, then 0.0625 m until it stands; the person comes 0.3 m nearer in a second."""
    person = np.array([(2.0, 0.0, -0.3, 0.0, 0.3)])
    drive = (0.5, 0.0, 0.0)
    found = least_gap(person, DISC, LIMITS, (0.0, 0.0, 1.0, 0.0), drive, drive, (0.4, 1.0), 9.0)
    assert found == pytest.approx(2.0 - 0.3 - 0.2 - 0.3 - (0.2 + 0.0625), abs=0.006)
    assert least_gap(person, DISC, LIMITS, (0.0, 0.0, 1.0, 0.0), drive, drive, (0.4, 1.0), 0.5) == 0.5
    assert least_gap(np.empty((0, 5)), DISC, LIMITS, (0.0, 0.0, 1.0, 0.0), drive, drive, (0.4, 1.0), 9.0) == 9.0
