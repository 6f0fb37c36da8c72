"""Optimal reciprocal collision avoidance for the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_planners(register: Register) -> None:
    """Offer the optimal reciprocal collision avoidance."""
    register("orca", "arena_orca.planner:OrcaPlanner")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_orca.conf"
