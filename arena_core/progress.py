"""The progress bar of a run: episodes done, rate, successes and time left; silent where there is no terminal."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from types import TracebackType
from typing import Any


class Progress:
    """Count finished episodes of ``total``, ``done`` of which were there before."""

    def __init__(self, total: int, done: int) -> None:
        self._bar = _bar() if sys.stderr.isatty() else None
        self._task = self._bar.add_task("episodes", total=total, completed=done, successes="-") if self._bar else None
        self._successes = 0
        self._seen = 0

    def __enter__(self) -> Progress:
        if self._bar:
            self._bar.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar:
            self._bar.stop()

    def add(self, row: Mapping[str, Any]) -> None:
        """Take in the row of a finished episode."""
        self._seen += 1
        self._successes += bool(row.get("success", row["outcome"] == "goal_reached") == 1.0)
        if self._bar and self._task is not None:
            self._bar.update(self._task, advance=1, successes=f"{self._successes}/{self._seen}")


def _bar() -> Any:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, ProgressColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as RichProgress
    from rich.text import Text

    class Rate(ProgressColumn):
        def render(self, task: Any) -> Text:
            return Text(f"{task.speed:.2f}/s" if task.speed else "-/s")

    return RichProgress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        Rate(),
        TextColumn("success {task.fields[successes]}"),
        TimeRemainingColumn(),
        console=Console(stderr=True),
    )
