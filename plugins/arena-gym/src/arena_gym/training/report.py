"""What a training says while it runs: a bar on a terminal, a line a validation everywhere."""

from __future__ import annotations

import sys
from collections import deque

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

LATE = 300  # episodes that success and collisions are of


class TrainingReport(Progress):
    """A bar of steps with time left, level, success and collisions of late episodes; silent where there is no terminal."""

    def __init__(self, total_steps: int) -> None:
        said = (
            TextColumn("success {task.fields[success]}"),
            TextColumn("collisions {task.fields[collisions]}"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
        )
        columns = TextColumn("{task.description}"), BarColumn(bar_width=20), MofNCompleteColumn(), *said
        super().__init__(*columns, console=Console(stderr=True), disable=not sys.stderr.isatty(), speed_estimate_period=120.0)
        self._steps = self.add_task("training", total=total_steps, success="-", collisions="-")

    def begin(self, steps: int) -> None:
        """Show from where training goes on; the time left counts from here."""
        self.reset(self._steps, completed=steps)

    def note(self, steps: int, late: LateEpisodes, level: str) -> None:
        """Show how it stands; ``level`` is empty where there is none."""
        success, collisions = (f"{late.success:.2f}", f"{late.collisions:.2f}") if late.episodes else ("-", "-")
        self.update(self._steps, completed=steps, description=f"training{level}", success=success, collisions=collisions)


class LateEpisodes:
    """Success without collision, and collisions, of the latest training episodes."""

    def __init__(self) -> None:
        self._ends: deque[tuple[bool, int]] = deque(maxlen=LATE)

    def add(self, success: bool, collisions: int) -> None:
        """Add an episode that ended."""
        self._ends.append((success, collisions))

    @property
    def episodes(self) -> int:
        """Return how many there are."""
        return len(self._ends)

    @property
    def success(self) -> float:
        """Return the share that succeeded without a collision, 0 where there are none."""
        return sum(success for success, _ in self._ends) / max(1, len(self._ends))

    @property
    def collisions(self) -> float:
        """Return the collisions an episode, 0 where there are none."""
        return sum(collisions for _, collisions in self._ends) / max(1, len(self._ends))

    def state(self) -> list[list[int]]:
        """Return what a checkpoint keeps."""
        return [[int(success), collisions] for success, collisions in self._ends]

    def restore(self, state: list[list[int]]) -> None:
        """Go on from a checkpoint."""
        self._ends = deque(((bool(success), int(collisions)) for success, collisions in state), maxlen=LATE)
