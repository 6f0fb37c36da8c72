"""Discs on straight legs from time to time."""

import numpy as np
import pytest

from arena_kernels.compiled import borrowing
from arena_kernels.foreseen import Foreseen, leg_at, place_on

BENT = Foreseen.of(
    np.array((0.0, 1.0, 2.0)),
    np.array((((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)),)),
    np.array((((1.0, 0.0), (0.0, 1.0), (0.0, -2.0)),)),
)


@borrowing
def place(foreseen, disc, time):
    return place_on(foreseen, disc, leg_at(foreseen, time), time)


@pytest.mark.parametrize(
    ("time", "expected"),
    [(0.0, (0.0, 0.0)), (0.5, (0.5, 0.0)), (1.0, (1.0, 0.0)), (1.5, (1.0, 0.5)), (2.0, (1.0, 1.0)), (3.0, (1.0, -1.0))],
)
def test_a_disc_is_on_the_leg_of_its_time_and_on_the_last_one_for_good(time, expected):
    assert place(BENT, 0, time) == pytest.approx(expected)


def test_discs_that_keep_their_velocity_are_the_very_numbers_of_a_straight_line():
    positions, velocities = np.array(((0.1, 0.7),)), np.array(((0.3, -0.9),))
    straight = Foreseen.straight(positions, velocities)
    for time in (0.1, 0.37, 4.0):
        assert place(straight, 0, time) == (0.1 + time * 0.3, 0.7 + time * -0.9)
