"""ROS for the arena suite: bags in and out, robots and foreign planners. Nothing of ROS is imported until it is used."""

from arena_core import Register, hookimpl


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena ros``."""
    register("ros", "arena_ros.commands:RosCommand")
