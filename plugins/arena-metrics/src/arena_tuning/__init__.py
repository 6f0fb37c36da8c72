"""Values of a planner's parameters that suit a robot: searched, chosen, judged, and kept with a card."""

from arena_core import Register, hookimpl


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena tune``."""
    register("tune", "arena_tuning.command:TuneCommand")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_tuning.conf"
