"""What the state machine remembers of each person and each world."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_pedsim.states.behaviour import TRAITS

NOBODY, ROBOT, NOT_MET = -1, -2, -3  # partners that are no place in the list of people

MIND = np.dtype(
    [
        ("own_social", np.float64),  # m/s^2, the size of others' repulsion when walking
        ("clock", np.float64),  # s in this state; in a queue, s at its head
        ("duration", np.float64),  # s that the state lasts, inf without an end of its own
        ("centre_x", np.float64),  # where the state was entered; of a queue, its head
        ("centre_y", np.float64),
        ("queue_heading", np.float64),  # rad, where a queue looks
        ("way_x", np.float64),  # the way that an errand interrupted: its goal and its corners
        ("way_y", np.float64),
        ("way_corner", np.int32),
        ("way_corners", np.int32),
        ("traits", np.float64, (len(TRAITS),)),
        ("state", np.int32),  # as the state machine left it
        ("partner", np.int32),  # place in the list of people, NOBODY or ROBOT
        ("company", np.int32),  # how many stand in the circle around the centre
        ("place", np.int32),  # in the queue, 0 at its head
        ("group", np.int32),  # number of the group or NOBODY
        ("queue", np.int32),  # number of the queue or NOBODY
        ("queue_waypoint", np.int32),
        ("serves", np.int32),  # 1: a service robot
    ],
    align=True,
)

WORLD = np.dtype(
    [
        ("key", np.uint64),  # of the world's random stream
        ("clock", np.float64),  # s since chances were tested
        ("goal_x", np.float64),  # of the robot
        ("goal_y", np.float64),
        ("groups", np.int64),  # number of them
        ("lively", np.int64),  # 0: no one will ever leave walking and waiting
    ],
    align=True,
)


class SocialArrays(NamedTuple):
    """The social side of N worlds: ``minds`` (N, P), ``worlds`` (N,); ``links`` (3, P) and
    ``angles`` (P,) are room to work in.
    """

    minds: NDArray[np.void]
    worlds: NDArray[np.void]
    links: NDArray[np.int32]
    angles: NDArray[np.float64]
