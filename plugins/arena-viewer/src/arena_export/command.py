"""``arena export``: records of runs in a form that another program reads."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from arena_core import ConfigurationError, InputFileError
from arena_core.commands import Command, print_notice, read_words
from arena_core.hosting import Registry, load_registry
from arena_core.parameters import NonNegativeInt, read_settings
from arena_core.records import Export, find_runs, record_paths

USAGE = "arena export RUN [EPISODE...] to=FORM [out=PATH]"
PLACE = "exports"  # where a run's exports lie unless out names another place


class ExportCommand(Command):
    """Write the records of runs in a form that plugins offer."""

    help: ClassVar[str] = "records for other programs: arena export RUN [EPISODE...] to=FORM [out=PATH]"

    def run(self, arguments: Sequence[str]) -> int:
        """Export every run at or below the folder; each path that was written is printed."""
        registry = load_registry()
        if not arguments or any(word in ("-h", "--help") for word in arguments):
            print(_usage(registry))
            return 0
        words = read_words(USAGE, arguments, names=None, keys=("to", "out"))
        if not words.names:
            raise ConfigurationError(f"arguments are none; allowed: {USAGE}")
        form, folder = words.required("to"), Path(words.names[0])
        numbers = [_episode_number(word) for word in words.names[1:]]
        export = _build(registry, form)
        runs, out = sorted(find_runs(folder)), words.value("out", str | None, None)
        for run in runs:
            target = run / PLACE / (form if not export.ending else f"episodes{export.ending}")
            if out is not None:
                target = Path(out) if len(runs) == 1 else Path(out) / _with_ending(run.relative_to(folder), export)
            if target.suffix != export.ending and export.ending:
                raise ConfigurationError(f"out is {target.name}; allowed: a name that ends in {export.ending}")
            export_run(export, run, target, numbers)
            print_notice(f"{target}")
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Offer the forms."""
        return [f"to={name}" for name in load_registry().names("export") if f"to={name}".startswith(word) and word]


def export_run(export: Export, run: Path, target: Path, numbers: Sequence[int]) -> None:
    """Write the episodes of a run (none are named: all that have records) to a place that is free; raise ArenaError."""
    known = [int(path.stem) for path in record_paths(run)]
    if not known:
        raise InputFileError(f"{run}: has no records; allowed: a folder that `arena run` wrote")
    if missing := sorted(set(numbers) - set(known)):
        raise ConfigurationError(f"EPISODE is {missing[0]}; allowed: {', '.join(map(str, known))}")
    if target.exists():
        raise ConfigurationError(f"{target} is there already; allowed: a name that is free, out=PATH")
    export.write(run, target, numbers or known)


def _build(registry: Registry, form: str) -> Export:
    export: Export = registry.component("export", form).resolve()()
    return export


def _episode_number(word: str) -> int:
    return read_settings(int(word) if word.isdecimal() else word, NonNegativeInt, "EPISODE")


def _with_ending(path: Path, export: Export) -> Path:
    return path.with_name(path.name + export.ending)


def _usage(registry: Registry) -> str:
    names = registry.names("export")
    forms = [f"  {name:<12} {_build(registry, name).help}" for name in names]
    return "\n".join([f"usage: {USAGE}", "", "forms:", *forms])
