"""TurtleBot3, Jackal and Robotino for the arena suite."""

from arena_core import Register, hookimpl

ROBOTS = ("turtlebot3", "jackal", "robotino", "jackal_ackermann")


@hookimpl
def register_robots(register: Register) -> None:
    """Offer the paper's three robots, and the Jackal as the Ackermann vehicle that the paper calls it."""
    for name in ROBOTS:
        register(name, "arena_core:make_robot")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_robots.conf"
