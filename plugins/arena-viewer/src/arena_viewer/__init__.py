"""Replay of recorded episodes: in a browser, as one page, as a film or a strip of pictures."""

from arena_core import Register, hookimpl


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena replay``."""
    register("replay", "arena_viewer.command:ReplayCommand")
