"""The suite in the browser: runs, results, and editors of maps, scenarios and curricula."""

from arena_core import Register, hookimpl


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena studio``."""
    register("studio", "arena_studio.command:StudioCommand")
