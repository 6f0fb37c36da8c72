"""The state that the kernels step: one row a robot, one row a person, and what stands around them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import inner
from arena_kernels.footprint import Body
from arena_kernels.grids import GridStack
from arena_kernels.legs import Gait
from arena_kernels.walls import Walls

Floats = NDArray[np.float64]
Rows = NDArray[np.void]
Row = Any  # one row of the tables below; its fields read and write as attributes in compiled code

ROBOT = np.dtype(
    [
        *((name, np.float64) for name in ("x", "y", "theta")),  # in map
        *((name, np.float64) for name in ("vx", "vy", "wz")),  # in base_link
        ("speed_share", np.float64),  # of the robot's speed limits that it may drive
        ("kind", np.int64),  # place of its type among those of the worlds
        ("absent", np.int64),  # 1: it is not in the world, but far away; it neither moves nor senses
        ("alone", np.int64),  # 1: it meets nothing in the ticks that are run
        ("tick", np.int64),  # inner steps since the episode began
        ("people", np.int64),  # how many there are
        ("obstacles", np.int64),
        ("doors", np.int64),
        ("contact_ticks", np.int64),  # in contact, since it was last set to zero
        ("contacts", np.int64),  # rising edges noted, likewise
        *((name, np.float64) for name in ("odometry_x", "odometry_y", "odometry_theta")),  # in odom
        *((name, np.float64) for name in ("odometry_vx", "odometry_vy", "odometry_wz")),
        # the true pose then
        *((name, np.float64) for name in ("odometry_from_x", "odometry_from_y", "odometry_from_theta")),
        ("odometry_tick", np.int64),
        ("odometry_key", np.uint64),
        ("scan_tick", np.int64),
        ("scan_key", np.uint64),
    ]
)
PERSON = np.dtype(
    [
        ("id", np.int64),
        *((name, np.float64) for name in ("x", "y", "vx", "vy", "radius")),
        *((name, np.float64) for name in ("dx", "dy")),  # a tick's way
        ("walks", np.int64),  # 1: lidars see two legs
        # steps walked, and the velocity that the legs have taken up
        *((name, np.float64) for name in ("steps", "leg_vx", "leg_vy")),
        *((name, np.float64) for name in ("from_x", "from_y")),  # where it was when the steps were last counted
        ("through_walls", np.int64),  # 1: nothing that stands stops it
        ("alone", np.int64),  # 1: it meets nothing in the ticks that are run
    ]
)
CONTACT = np.dtype(
    [
        *((name, np.int64) for name in ("tick", "thing", "person", "caused")),
        *((name, np.float64) for name in ("speed", "x", "y")),
    ]
)
# A disc (no sides: first == last), or a polygon within that disc with the sides from first to last. ``meets`` tells who
# meets it.
OBSTACLE = np.dtype(
    [
        *((name, np.float64) for name in ("x", "y", "radius")),
        ("first", np.int64),
        ("last", np.int64),
        ("meets", np.int64),
    ]
)
# A door is one of the obstacles; the intervals from first to last say when it is open, again every ``period`` s (inf:
# once).
DOOR = np.dtype(
    [
        *((name, np.int64) for name in ("obstacle", "first", "last", "open")),
        ("period", np.float64),
    ]
)
BEAMS, ROBOTS, PEOPLE = 1, 2, 4  # who may meet an obstacle: a part of furniture is above or below some of them


class Worlds(NamedTuple):
    """N worlds of ``team`` robots each: ``robots`` (R,) with R = N team, row k team + m being robot m of world k,
    ``people`` (N, P), ``obstacles`` (N, O) with ``sides`` (N, S, 2, 2), and grid ``grid_of[k]`` of a stack. ``doors``
    (N, D) open in the intervals ``openings`` (N, I, 2), s.

    ``touching`` (R, M) tells which things each robot touches: 0 the walls, then its obstacles, from ``first_person`` on
    its people, then the robots of its team. ``contacts`` (R, E) are the rising edges. ``bodies``
    are one of each type of robot; they and ``person`` are put wherever a gap is asked for, and so is the ``outline`` of
    another robot, a polygon's sides (C, 2, 2) in order. ``gait`` is that of all who walk.
    """

    stack: GridStack
    grid_of: NDArray[np.int64]
    obstacles: Rows
    sides: Floats
    doors: Rows
    openings: Floats
    robots: Rows
    people: Rows
    touching: NDArray[np.bool_]
    contacts: Rows
    first_person: int
    bodies: tuple[Body, ...]
    person: Body
    outline: Floats
    gait: Gait

    @property
    def team(self) -> int:
        """Return how many robots a world has; kernels ask ``team_of``."""
        return len(self.robots) // max(len(self.people), 1)

    @property
    def first_robot(self) -> int:
        """Return the column of ``touching`` from which on the robots stand."""
        return self.first_person + int(self.people.shape[1])


@inner
def team_of(worlds: Worlds) -> int:
    """Return how many robots a world has."""
    return len(worlds.robots) // max(len(worlds.people), 1)


class World(NamedTuple):
    """The world of the robot in row ``k``, see ``Worlds``; its team stands from row ``first`` on, with what each
    touches (team, M) and the rising edges (team, E). ``first_robot`` is the column of the team's first robot, ``body``
    that of the robot in row ``k``.
    """

    walls: Walls
    obstacles: Rows
    sides: Floats
    doors: Rows
    openings: Floats
    robots: Rows
    k: int
    people: Rows
    touching: NDArray[np.bool_]
    contacts: Rows
    first_person: int
    first_robot: int
    team: int
    first: int
    team_touching: NDArray[np.bool_]
    team_contacts: Rows
    body: Body
    bodies: tuple[Body, ...]
    person: Body
    outline: Floats
