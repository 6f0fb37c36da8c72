"""Where one frame is in another, by the links that were heard."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from arena_core import Pose

Links = Mapping[str, tuple[str, Pose]]  # child frame: its parent, and its pose in that
BASES = frozenset({"base_link", "base_footprint"})  # REP-105, REP-120: both stand where the robot does


def mounted(links: Links, frame: str, bases: Collection[str]) -> Pose | None:
    """Return the pose of a frame in the first of some frames that the links lead up to; None where they lead to none."""
    pose = Pose(0.0, 0.0)
    for _ in range(len(links) + 1):  # links may run in a ring
        if frame in bases:
            return pose
        if frame not in links:
            return None
        frame, step = links[frame]
        pose = step.compose(pose)
    return None
