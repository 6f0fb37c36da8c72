"""What the planner nodes of the tests have in common, whatever ROS they are of: plain Python, without this project."""

import math
import threading

KINDS = ("odometry", "waypoint", "clock")


def yaw(q):
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


def command(pose, target):
    """Return speed and turn towards a point."""
    bearing = math.atan2(target.y - pose.position.y, target.x - pose.position.x) - yaw(pose.orientation)
    bearing = math.atan2(math.sin(bearing), math.cos(bearing))
    return 0.5 if abs(bearing) < 0.5 else 0.0, max(-1.0, min(1.0, 2.0 * bearing))


class Steps:
    """Calls ``answer(stamp, speed, turn)`` once odometry, waypoint and clock of one step are there, for so many steps
    at most.

    Stamps are seconds and nanoseconds. Messages may come in several threads.
    """

    def __init__(self, answer, steps):
        self.answer, self.left = answer, steps
        self.newest, self.lock = {}, threading.Lock()

    def take(self, kind, stamp, message):
        with self.lock:
            self.newest[kind] = stamp, message
            stamps = {each[0] for each in self.newest.values()}
            if len(self.newest) < len(KINDS) or len(stamps) > 1:
                return
            self.left -= 1
            if self.left >= 0:
                self.answer(
                    stamp, *command(self.newest["odometry"][1].pose.pose, self.newest["waypoint"][1].pose.position)
                )
