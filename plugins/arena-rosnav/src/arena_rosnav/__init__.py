"""ROSNAV, a local planner learned by reinforcement."""

from arena_core import Register, hookimpl


@hookimpl
def register_planners(register: Register) -> None:
    """Offer ROSNAV."""
    register("rosnav", "arena_rosnav.planner:Rosnav")


@hookimpl
def register_policies(register: Register) -> None:
    """Offer its policies."""
    register("rosnav/rosnav", "pkg://arena_rosnav/policies")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_rosnav.conf"
