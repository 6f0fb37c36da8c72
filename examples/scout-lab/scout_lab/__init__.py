"""A laboratory's own robot, planner and metrics."""

from arena_core import Register, hookimpl


@hookimpl
def register_robots(register: Register) -> None:
    """Offer the robot."""
    register("scout", "arena_core:make_robot")


@hookimpl
def register_planners(register: Register) -> None:
    """Offer the planner."""
    register("vfh_plus", "scout_lab.vfh_plus:VfhPlus")


@hookimpl
def register_metrics(register: Register) -> None:
    """Offer the pack of metrics."""
    register("hesitation", "scout_lab.hesitation:HesitationMetrics")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "scout_lab.conf"
