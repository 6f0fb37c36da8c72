"""What a transport has to do, as tests that every package of one runs, and what they need: a
site, a robot, bystanders.
"""

from arena_ros.testing.drives import DriveTests
from arena_ros.testing.fake_robot import FakeRobot, RobotProbe
from arena_ros.testing.faults import FaultTests
from arena_ros.testing.planners import PlannerTests
from arena_ros.testing.processes import ARENA, run_process, wait_until
from arena_ros.testing.site import world_overrides, write_site

__all__ = [
    "ARENA",
    "DriveTests",
    "FakeRobot",
    "FaultTests",
    "PlannerTests",
    "RobotProbe",
    "run_process",
    "wait_until",
    "world_overrides",
    "write_site",
]
