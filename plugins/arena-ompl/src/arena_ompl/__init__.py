"""Sampling-based global planners from OMPL for the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_global_planners(register: Register) -> None:
    """Offer the sampling-based planners of OMPL."""
    register("ompl", "arena_ompl.planner:OmplPlanner")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_ompl.conf"
