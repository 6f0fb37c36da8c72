"""Nonlinear model predictive control for the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_planners(register: Register) -> None:
    """Offer the nonlinear model predictive controller."""
    register("mpc", "arena_mpc.planner:MpcPlanner")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_mpc.conf"
