"""Where the wheels say the robot was, at any stamp of the recent past."""

from __future__ import annotations

from bisect import bisect_right
from collections import deque

from arena_core import Odometry, Pose

KEPT = 64  # messages; at one per control step of 0.1 s more than the age of any scan


class OdometryHistory:
    """The latest odometry messages, read at any stamp."""

    def __init__(self) -> None:
        self._messages: deque[Odometry] = deque(maxlen=KEPT)

    def add(self, odometry: Odometry) -> None:
        """Take in a message; one that is not newer than the last is ignored."""
        if not self._messages or odometry.stamp > self._messages[-1].stamp:
            self._messages.append(odometry)

    def at(self, stamp: float) -> Pose:
        """Return the pose in ``odom`` at ``stamp``: between two messages on the straight line, after the
        last one along its twist.
        """
        last = self._messages[-1]
        if stamp >= last.stamp:
            return _extrapolate_pose(last, stamp - last.stamp)
        later = bisect_right(self._messages, stamp, key=lambda message: message.stamp)
        if later == 0:
            return self._messages[0].pose
        before, after = self._messages[later - 1], self._messages[later]
        share = (stamp - before.stamp) / (after.stamp - before.stamp)
        step = before.pose.relative(after.pose)
        return before.pose.compose(Pose(share * step.x, share * step.y, share * step.theta))


def _extrapolate_pose(odometry: Odometry, duration: float) -> Pose:
    """Return the pose ``duration`` s after a message, the twist held, the displacement along the mean heading."""
    if duration == 0.0:
        return odometry.pose
    twist = odometry.twist
    half = Pose(0.0, 0.0, 0.5 * twist.wz * duration)
    return odometry.pose.compose(half).compose(Pose(twist.vx * duration, twist.vy * duration)).compose(half)
