"""What a training says while it runs: a bar on a terminal, a line an evaluation everywhere."""

from __future__ import annotations

import sys

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn


class TrainingReport(Progress):
    """A bar of steps with level and share of late episodes that succeeded; silent where there is no terminal."""

    def __init__(self, total_steps: int) -> None:
        columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn("success {task.fields[success]}")
        super().__init__(*columns, TimeRemainingColumn(), console=Console(stderr=True), disable=not sys.stderr.isatty())
        self._steps = self.add_task("training", total=total_steps, success="-")

    def note(self, steps: int, success: float, level: int) -> None:
        """Show progress: ``success`` of late training episodes, 0 .. 1."""
        self.update(self._steps, completed=steps, description=f"training, level {level}", success=f"{success:.2f}")
