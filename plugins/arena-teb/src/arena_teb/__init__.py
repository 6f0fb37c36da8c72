"""Timed elastic band planner for the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_planners(register: Register) -> None:
    """Offer the timed elastic band."""
    register("teb", "arena_teb.planner:TebPlanner")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_teb.conf"
