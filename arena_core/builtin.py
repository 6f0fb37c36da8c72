"""What the core itself offers, through the same door as every plugin."""

from arena_core.hookspecs import Register, hookimpl


@hookimpl
def register_executors(register: Register) -> None:
    """Offer serial execution and worker processes."""
    register("serial", "arena_core.executors:SerialExecutor")
    register("processes", "arena_core.executors:ProcessExecutor")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer the subcommands that need no plugin."""
    register("run", "arena_core.commands:RunCommand")
    register("evaluate", "arena_core.commands:EvaluateCommand")
    register("list", "arena_core.listing:ListCommand")
    register("check", "arena_core.testing:CheckCommand")
    register("new", "arena_core.scaffold:NewCommand")
