"""Model predictive path integral control for the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_planners(register: Register) -> None:
    """Offer the model predictive path integral controller."""
    register("mppi", "arena_mppi.planner:MppiPlanner")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_mppi.conf"
