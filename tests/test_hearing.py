"""Teammates that were heard of are tracks, in place of what the tracker makes of their bodies."""

import math

import numpy as np
import pytest

from arena_core import NO_TRACKS, Pose, Twist
from arena_core.loop.hearing import FIRST_HEARD, add_heard
from arena_core.tasks import Message
from arena_core.testing import tracked


def message(pose, twist, *, stamp=0.0, sender=1, variance=0.0):
    return Message(sender, stamp, pose, twist, variance * np.eye(3), 0.3)


def test_without_messages_tracks_are_what_the_tracker_said():
    tracks = tracked((1.0, 0.0, 0.5, 0.0))
    assert add_heard(tracks, (), 1.0) is tracks


def test_a_teammate_has_gone_on_at_its_velocity_since_it_told():
    told = add_heard(NO_TRACKS, [message(Pose(1.0, 2.0, math.pi / 2), Twist(0.5, 0.1))], 0.4)
    assert told.ids.tolist() == [FIRST_HEARD + 1]
    assert told.velocities[0] == pytest.approx((-0.1, 0.5))
    assert told.positions[0] == pytest.approx((1.0 - 0.04, 2.0 + 0.2))
    assert told.radii.tolist() == [0.3]


def test_the_older_a_message_the_less_is_it_trusted():
    near, far = (add_heard(NO_TRACKS, [message(Pose(0.0, 0.0), Twist(0.5), variance=0.01)], age) for age in (0.0, 1.0))
    assert near.covariances[0] == pytest.approx(np.diag((0.01, 0.01, 0.0, 0.0)))
    assert far.covariances[0].diagonal() == pytest.approx((0.01 + 0.5 / 3, 0.01 + 0.5 / 3, 0.5, 0.5))
    assert (np.linalg.eigvalsh(far.covariances[0]) > 0.0).all()


def test_the_tracks_own_view_of_a_teammate_gives_way_and_people_stay():
    seen = tracked((1.1, 0.05, 0.4, 0.0), (1.0, 0.8, 0.0, 0.0), (3.0, 0.0, 0.0, 0.0), radius=0.3)
    told = add_heard(seen, [message(Pose(1.0, 0.0), Twist(0.5))], 0.0)
    assert told.ids.tolist() == [1, 2, FIRST_HEARD + 1]
    assert told.positions.tolist() == [[1.0, 0.8], [3.0, 0.0], [1.0, 0.0]]


def test_a_track_without_numbers_costs_no_other_one():
    told = add_heard(tracked((np.nan, np.nan, 0.0, 0.0)), [message(Pose(1.0, 0.0), Twist(0.5))], 0.0)
    assert told.ids.tolist() == [0, FIRST_HEARD + 1]
