"""What was recorded of one episode, and which of it counts as a number."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import Pose
from arena_ros.bags.series import PersonSightings, Series
from arena_ros.bags.transform_tree import TransformTree

FARTHEST = 2e7  # m, farther than any coordinate on Earth (UTM's reach 1e7); beyond, and at 1e3 m/s, numbers are none
FASTEST = 1e3  # m/s
SETTLED = 10**9  # ns after the begin of an episode from which on a counter's first message is an event


@dataclass(eq=False)
class EpisodeMessages:
    """All that was recorded of one episode; stamps in ns.

    What has a place has it in the frame in which it was recorded.
    """

    begin: int
    goal: tuple[str, Pose] | None = None
    why_ended: str = "the recording ended"
    meta: Mapping[str, Any] | None = None  # what our own export says of it
    ending: Mapping[str, Any] | None = None
    frame: str = "odom"  # of odometry
    base: str = "base_link"
    odometry: Series = field(default_factory=lambda: Series(6))  # x, y, theta in frame, vx, vy, wz
    # by frame: x, y, theta, vx, vy, wz (NaN where only a pose)
    reference: dict[str, Series] = field(default_factory=dict)
    estimate: dict[str, Series] = field(default_factory=dict)  # by frame: pose and its covariance
    command: Series = field(default_factory=lambda: Series(3))
    scan: Series = field(default_factory=lambda: Series(2))  # nearest return, clearance by the scan
    waypoint: Series = field(default_factory=lambda: Series(3))
    counts_collisions: bool = False
    # how many, and whether it touches (NaN where that is not told)
    collisions: Series = field(default_factory=lambda: Series(2))
    state: list[tuple[int, NDArray[np.float64]]] = field(default_factory=list)
    ranges: list[tuple[int, NDArray[np.float32]]] = field(default_factory=list)
    paths: list[tuple[int, str, NDArray[np.float64]]] = field(default_factory=list)
    people: dict[str, PersonSightings] = field(default_factory=dict)  # by frame
    links: TransformTree = field(default_factory=lambda: TransformTree(()))


def is_settled(now: EpisodeMessages, stamp: int) -> bool:
    """Return whether an episode has gone on long enough for what a counter says first to be an event."""
    return stamp - now.begin > SETTLED


def person_number(name: str, place: int) -> int:
    """Return the number in a person's name, else the place in the message."""
    digits = "".join(character for character in name if character.isdigit())[-9:]
    return int(digits) if digits else place


def are_numbers(places: Iterable[float], speeds: Iterable[float] = ()) -> bool:
    """Return whether places and speeds are numbers that can be."""
    near, slow = np.abs(np.asarray(list(places))) < FARTHEST, np.abs(np.asarray(list(speeds))) < FASTEST
    return bool(near.all() and slow.all())


def position_and_rotation(transform: Any) -> NDArray[np.float64]:
    """Return place and turn of a transform, the turn of length 1; one of length 0 is none."""
    place, turn = transform.transform.translation, transform.transform.rotation
    q = np.array([turn.x, turn.y, turn.z, turn.w])
    length = float(np.linalg.norm(q))
    return np.concatenate(([place.x, place.y, place.z], q / length if length != 0.0 else (0.0, 0.0, 0.0, 1.0)))
