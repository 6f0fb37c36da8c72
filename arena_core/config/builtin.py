"""What the core itself offers, through the same door as every plugin."""

from arena_core.contracts.hookspecs import Register, hookimpl


@hookimpl
def register_executors(register: Register) -> None:
    """Offer serial execution and worker processes."""
    register("serial", "arena_core.runs.workers.executors:SerialExecutor")
    register("processes", "arena_core.runs.workers.executors:ProcessExecutor")


@hookimpl
def register_references(register: Register) -> None:
    """Offer to find out nothing."""
    register("none", "arena_core.runs.references:NoReference")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer the subcommands that need no plugin."""
    register("quickstart", "arena_core.cli.quickstart:QuickstartCommand")
    register("run", "arena_core.cli.commands:RunCommand")
    register("evaluate", "arena_core.cli.commands:EvaluateCommand")
    register("list", "arena_core.cli.listing:ListCommand")
    register("check", "arena_core.cli.check:CheckCommand")
    register("profile", "arena_core.cli.profiling:ProfileCommand")
    register("new", "arena_core.cli.scaffold:NewCommand")
    register("completion", "arena_core.cli.completion:CompletionCommand")
