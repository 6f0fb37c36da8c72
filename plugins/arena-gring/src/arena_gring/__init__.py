"""GRING, a local planner learned by reinforcement that follows waypoints and stops for people."""

from arena_core import Register, hookimpl


@hookimpl
def register_planners(register: Register) -> None:
    """Offer GRING."""
    register("gring", "arena_gring.planner:Gring")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_gring.conf"
