"""ROS for the arena suite: bags in and out, robots and foreign planners.

Nothing of ROS is imported until it is used.
"""

from arena_core import Register, hookimpl


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena ros``."""
    register("ros", "arena_ros.commands:RosCommand")


@hookimpl
def register_exports(register: Register) -> None:
    """Offer recordings of ROS 1 and ROS 2."""
    register("mcap", "arena_ros.bags.forms:McapExport")
    register("bag", "arena_ros.bags.forms:BagExport")


@hookimpl
def register_planners(register: Register) -> None:
    """Offer a planner that is a ROS node of its own."""
    register("ros_external", "arena_ros.live.external:RosExternal")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_ros.conf"
