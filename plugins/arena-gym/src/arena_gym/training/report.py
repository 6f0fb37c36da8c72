"""What a training says while it runs: a bar on a terminal, a line an evaluation elsewhere."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import Any


class TrainingReport:
    """Shows steps done, the share of late episodes that succeeded, and each evaluation."""

    def __init__(self, total_steps: int) -> None:
        self._total = total_steps
        self._bar = _bar() if sys.stderr.isatty() else None
        self._task = self._bar.add_task("training", total=total_steps, success="-") if self._bar else None

    def __enter__(self) -> TrainingReport:
        if self._bar:
            self._bar.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar:
            self._bar.stop()

    def show(self, steps: int, success: float, level: int) -> None:
        """Show progress: ``success`` of late training episodes, 0 .. 1."""
        if self._bar and self._task is not None:
            self._bar.update(self._task, completed=steps, description=f"training, level {level}", success=f"{success:.2f}")

    def say(self, line: str) -> None:
        """Print a line that stays."""
        print(line) if self._bar is None else self._bar.console.print(line)
        sys.stdout.flush()


def _bar() -> Any:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("success {task.fields[success]}"),
        TimeRemainingColumn(),
        console=Console(stderr=True),
    )
