"""Hard problems: searched against a planner, made as small as they can be, and certified to be solvable."""

from arena_core import Register, hookimpl


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_break.conf"


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena break``."""
    register("break", "arena_break.command:BreakCommand")
