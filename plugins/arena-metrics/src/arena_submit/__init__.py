"""The standing benchmark: packs of runs, their verification, and the table of those that stand."""

from arena_core import Register, hookimpl


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_submit.conf"


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena submit``, ``arena verify`` and ``arena leaderboard``."""
    register("submit", "arena_submit.commands:SubmitCommand")
    register("verify", "arena_submit.commands:VerifyCommand")
    register("leaderboard", "arena_submit.commands:LeaderboardCommand")
