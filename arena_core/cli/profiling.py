"""``arena profile``: where the time of a planner's control steps goes."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, ClassVar

from arena_core.base.whole_files import write_text_whole
from arena_core.cli.candidates import complete_overrides
from arena_core.cli.words import read_words
from arena_core.config.configuration import compose
from arena_core.config.registry import load_registry
from arena_core.contracts.running import Command
from arena_core.runs.jobs.benchmark import build_benchmark
from arena_core.runs.jobs.profiling import METRICS, TASK, Profile, profile_benchmark
from arena_core.values.parameters import Bounds

USAGE = "arena profile [KEY=VALUE ...] [first=3] [functions=15] [out=FILE.txt]"
Number = Annotated[int, Bounds(low=1, high=1000)]


class ProfileCommand(Command):
    """Run the first episodes of a configuration and tell where their time goes."""

    help: ClassVar[str] = f"where the time of a control step goes: {USAGE}"

    def run(self, arguments: Sequence[str]) -> int:
        """Print a table of parts, and the functions that take most; ``out`` keeps it as a file."""
        words = read_words(USAGE, arguments, keys=("first", "functions", "out"), overrides=None)
        episodes, most = words.value("first", Number, 3), words.value("functions", Number, 15)
        benchmark = build_benchmark(compose(words.overrides), load_registry())
        text = "\n".join(profile_lines(profile_benchmark(benchmark, episodes, _print_stage), most))
        print(text)
        if "out" in words.keys:
            write_text_whole(Path(words.keys["out"]), f"{text}\n")
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return what a run takes, and the command's own keys."""
        return [
            *(key for key in ("first=", "functions=", "out=") if key.startswith(word)),
            *complete_overrides(words, word),
        ]


def _print_stage(what: str) -> None:
    print(f"arena: {what}", file=sys.stderr, flush=True)


def profile_lines(found: Profile, most: int) -> list[str]:
    """Return the lines of a profile."""
    in_steps = {part: spent for part, spent in found.parts.items() if part not in (TASK, METRICS)}
    whole = sum(spent.cpu for spent in in_steps.values())
    times = f"{found.simulated:.1f} s simulated in {whole:.2f} s of CPU time, {found.simulated / whole:.0f} x real time"
    lines = [f"{found.episodes} episode{'s' * (found.episodes != 1)}, {found.steps} control steps: {times}", ""]
    lines += [f"{'ms a control step':24}{'all':>9}{'compiled':>10}{'libraries':>11}{'Python':>9}"]
    each = 1e3 / found.steps
    for part, spent in sorted(in_steps.items(), key=lambda item: -item[1].cpu):
        lines.append(_profile_row(part, each, spent.cpu, spent.compiled, spent.libraries, spent.python))
    sums = (
        sum(getattr(spent, name) for spent in in_steps.values()) for name in ("cpu", "compiled", "libraries", "python")
    )
    lines += [_profile_row("together", each, *sums), ""]
    once = [
        f"{part} {1e3 * found.parts[part].cpu / found.episodes:.1f}" for part in (TASK, METRICS) if part in found.parts
    ]
    lines += [
        f"ms an episode: {', '.join(once)}",
        "",
        f"{'ms a step':>9}  calls  most time in (Python as the profiler slows it)",
    ]
    for called in found.functions[:most]:
        file, line, name = called.place
        where = "called directly" if file == "~" else f"{Path(file).parent.name}/{Path(file).name}:{line}"
        name = name.removeprefix("<built-in method ").removesuffix(">").rpartition(".")[2]
        kind = " compiled" if called.compiled else ""
        lines.append(f"{called.own * each:9.4f}{called.calls / found.steps:7.2f}  {name} ({where}){kind}")
    return lines


def _profile_row(name: str, each: float, *spent: float) -> str:
    cpu, compiled, libraries, python = (each * seconds for seconds in spent)
    return f"{name:24}{cpu:9.3f}{compiled:10.3f}{libraries:11.3f}{python:9.3f}"
