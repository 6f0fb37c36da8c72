"""What a snapshot shows of the tables that the kernels step: robots and people, copied out in one pass each."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import ABSENT
from arena_kernels.compiled import borrowing
from arena_sim2d.bodies import Floats, Rows


class RobotReadout(NamedTuple):
    """What snapshots say of N robots, see ``Snapshot``."""

    stamps: Floats
    poses: Floats
    twists: Floats
    clearances: Floats
    clearances_people: Floats
    in_contact: NDArray[np.bool_]
    contact_times: Floats
    scan_stamps: Floats
    odometry_stamps: Floats
    odometry_poses: Floats
    odometry_twists: Floats


class PeopleReadout(NamedTuple):
    """Where people are, (N, P, 2) m and m/s, and their social states (N, P)."""

    positions: Floats
    velocities: Floats
    states: NDArray[np.int8]


def allocate_robot_readout(n: int) -> RobotReadout:
    """Return arrays for ``read_robots`` to fill."""
    vectors, numbers = np.empty((4, n, 3)), np.empty((6, n))
    stamps, clearances, clearances_people, contact_times, scan_stamps, odometry_stamps = numbers
    poses, twists, odometry_poses, odometry_twists = vectors
    return RobotReadout(
        stamps,
        poses,
        twists,
        clearances,
        clearances_people,
        np.empty(n, np.bool_),
        contact_times,
        scan_stamps,
        odometry_stamps,
        odometry_poses,
        odometry_twists,
    )


def allocate_people_readout(n: int, slots: int) -> PeopleReadout:
    """Return arrays for ``read_people`` to fill."""
    positions, velocities = np.empty((2, n, slots, 2))
    return PeopleReadout(positions, velocities, np.empty((n, slots), np.int8))


@borrowing
def read_robots(robots: Rows, touching: NDArray[np.bool_], gaps: Floats, step: float, into: RobotReadout) -> None:
    """Fill ``into`` from the robots' rows (N,), what they touch (N, M), and their gaps to walls,
    obstacles, people and other robots (N, 4).
    """
    for k in range(len(robots)):
        robot = robots[k]
        into.stamps[k], into.scan_stamps[k], into.odometry_stamps[k] = (
            robot.tick * step,
            robot.scan_tick * step,
            robot.odometry_tick * step,
        )
        into.poses[k, 0], into.poses[k, 1], into.poses[k, 2] = robot.x, robot.y, robot.theta
        if robot.absent:
            into.poses[k] = math.nan
        into.twists[k, 0], into.twists[k, 1], into.twists[k, 2] = robot.vx, robot.vy, robot.wz
        into.odometry_poses[k, 0], into.odometry_poses[k, 1] = robot.odometry_x, robot.odometry_y
        into.odometry_poses[k, 2] = robot.odometry_theta
        into.odometry_twists[k, 0], into.odometry_twists[k, 1] = robot.odometry_vx, robot.odometry_vy
        into.odometry_twists[k, 2] = robot.odometry_wz
        into.contact_times[k] = robot.contact_ticks * step
        into.clearances[k] = max(min(gaps[k, 0], gaps[k, 1], gaps[k, 2], gaps[k, 3]), 0.0)
        into.clearances_people[k] = max(gaps[k, 2], 0.0)
        into.in_contact[k] = touching[k].any()


@borrowing
def read_people(people: Rows, states: NDArray[np.int8], into: PeopleReadout) -> None:
    """Fill ``into`` from the people's rows (N, P) and the states that the pedestrian model gave
    them; who is nowhere is absent.
    """
    for k in range(people.shape[0]):
        for i in range(people.shape[1]):
            person = people[k, i]
            absent = math.isnan(person.x)
            into.positions[k, i, 0], into.positions[k, i, 1] = person.x, person.y
            into.velocities[k, i, 0] = math.nan if absent else person.vx
            into.velocities[k, i, 1] = math.nan if absent else person.vy
            into.states[k, i] = ABSENT if absent else states[k, i]
