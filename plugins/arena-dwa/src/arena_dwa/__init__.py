"""Dynamic window approach for the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_planners(register: Register) -> None:
    """Offer the dynamic window approach."""
    register("dwa", "arena_dwa.planner:DwaPlanner")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_dwa.conf"
