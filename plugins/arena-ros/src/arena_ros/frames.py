"""Where one frame is in another, by the links that were heard."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from arena_core import Pose


@dataclass(frozen=True, slots=True)
class Mount:
    """Where a frame is in another, as seen from above: its origin and the heading of its x axis.

    ``flipped`` tells that its z axis points down.
    """

    pose: Pose
    flipped: bool = False

    def compose(self, child: Mount) -> Mount:
        """Return where a frame is that is at ``child`` in this one."""
        x, y, theta = child.pose.array().tolist()
        seen = Pose(x, -y, -theta) if self.flipped else child.pose
        return Mount(self.pose.compose(seen), self.flipped is not child.flipped)


Links = Mapping[str, tuple[str, Mount]]  # child frame: its parent, and where it is in that
BASES = frozenset({"base_link", "base_footprint"})  # REP-105, REP-120: both stand where the robot does


def find_mount(links: Links, frame: str, bases: Collection[str]) -> Mount | None:
    """Return where a frame is in the first of some frames that the links lead up to; None where they lead to none."""
    mount = Mount(Pose(0.0, 0.0))
    for _ in range(len(links) + 1):  # links may run in a ring
        if frame in bases:
            return mount
        if frame not in links:
            return None
        frame, step = links[frame]
        mount = step.compose(mount)
    return None
