"""What a transport has to do, as tests that every package of one runs, and what they need: a site, a robot, bystanders."""

from arena_ros.testing.bystanders import Probe, Puppet
from arena_ros.testing.drives import DriveTests
from arena_ros.testing.faults import FaultTests
from arena_ros.testing.planners import PlannerTests
from arena_ros.testing.processes import ARENA, running, until
from arena_ros.testing.site import world, write_site

__all__ = ["ARENA", "DriveTests", "FaultTests", "PlannerTests", "Probe", "Puppet", "running", "until", "world", "write_site"]
