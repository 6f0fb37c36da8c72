"""The ladder: among how many people a planner breaks, by kind of world and crowd."""

from arena_core import Register, hookimpl


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena ladder``."""
    register("ladder", "arena_ladder.command:LadderCommand")
