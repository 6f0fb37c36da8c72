"""The command line: ``arena COMMAND ...``; every command is a component of some plugin."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence
from io import TextIOWrapper

from arena_core.base.ctrl_c import SIGNAL_STATUS, interrupts
from arena_core.base.errors import ArenaError, UnknownComponent
from arena_core.config.registry import Registry, load_registry, unknown_name

CUT_OFF = 141  # the same, when no one reads its output any more (arena list | head)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the exit status: 0 done, 1 some episode failed, 2 the request was wrong."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    registry: Registry | None = None
    _print_anything()
    try:
        try:
            registry = _load_registry()
            return _run_command(registry, arguments)
        finally:
            sys.stdout.flush()  # here, where a broken pipe is known; argparse ends the process after --help
    except ArenaError as error:
        print(f"arena: {error}", file=sys.stderr)
        return error.exit_status
    except KeyboardInterrupt as interrupt:
        came = signal.Signals(interrupt.args[0] if interrupt.args else signal.SIGINT)
        said = "interrupted" if came == signal.SIGINT else f"ended by {came.name}"
        print(
            "; ".join([f"arena: {said}", *getattr(interrupt, "__notes__", _kept_lines(registry, arguments))]),
            file=sys.stderr,
        )
        return SIGNAL_STATUS + came
    except BrokenPipeError:
        # or Python complains again when it flushes at its end
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return CUT_OFF


def _print_anything() -> None:
    """Let signs that a terminal or a file does not know be printed as question marks: Windows knows few by itself."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper) and stream.errors == "strict":
            stream.reconfigure(errors="replace")


def _run_command(registry: Registry, arguments: list[str]) -> int:
    if not arguments or arguments[0] in ("-h", "--help"):
        print(_usage_text(registry))
        return 0
    name, rest = arguments[0], arguments[1:]
    if name == "--version":
        from arena_core import __version__

        print(f"arena {__version__}")
        return 0
    if name not in registry.names("command"):
        raise UnknownComponent(unknown_name("command", name, registry.names("command")))
    command = registry.component("command", name).resolve()()
    return int(command.run(rest))


def _load_registry() -> Registry:
    """Return what all plugins offer; Ctrl-C waits until they are imported: libraries turn it
    into errors of their own.
    """
    with interrupts.heard(), interrupts.held():
        registry = load_registry()
        interrupts.check()
    return registry


def _kept_lines(registry: Registry | None, arguments: Sequence[str]) -> list[str]:
    """Return what the command that was interrupted leaves, if it leaves anything."""
    if registry is None or not arguments or arguments[0] not in registry.names("command"):
        return []
    kept = registry.component("command", arguments[0]).resolve().kept  # type: ignore[attr-defined]
    return [kept] if kept else []


def _usage_text(registry: Registry) -> str:
    commands = [registry.component("command", name) for name in registry.names("command")]
    lines = [f"  {c.name:10} {c.resolve().help}" for c in commands]  # type: ignore[attr-defined]
    return "\n".join(
        ["usage: arena COMMAND ...", "", "Benchmark obstacle avoidance of mobile robots among people.", "", *lines]
    )


if __name__ == "__main__":
    sys.exit(main())
