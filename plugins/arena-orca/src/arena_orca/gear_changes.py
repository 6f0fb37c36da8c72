"""When a robot that steers like a car backs up: where it cannot go on forwards, and then for a while."""

from __future__ import annotations

from arena_core import Pose
from arena_orca.motion import BACKWARD, FORWARD

MOVING = 0.02  # m/s: slower is not going on


class GearSelector:
    """Keeps a car-like robot in the backward gear until it has backed up ``distance`` m or
    cannot any more; others have one gear.
    """

    def __init__(self, distance: float, *, reversible: bool) -> None:
        self._reversible = reversible
        self._distance = distance
        self.clear()

    def clear(self) -> None:
        """Go forwards."""
        self._since: Pose | None = None

    def gear_order(self, pose: Pose) -> tuple[float, ...]:
        """Return the gears to try, in this order."""
        if not self._reversible:
            return (FORWARD,)
        if self._since is not None and self._since.distance(pose) >= self._distance:
            self.clear()
        return (FORWARD, BACKWARD) if self._since is None else (BACKWARD, FORWARD)

    def accept_command(self, pose: Pose, gear: float, vx: float, now: float) -> bool:
        """Return whether a command with ``vx`` (m/s) goes on in ``gear``, or brakes for it from the speed ``now``.

        Where backing up began is remembered.
        """
        if not self._reversible:
            return True
        brakes = gear * now < -MOVING and gear * (vx - now) > MOVING
        if gear * vx <= MOVING and not brakes:
            return False
        self._since = None if gear == FORWARD else self._since or pose
        return True
