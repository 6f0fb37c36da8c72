"""What a training says while it runs: lines everywhere, on a terminal a bar of steps, too, and
one of what is done besides.
"""

from __future__ import annotations

import sys
from collections import deque
from datetime import timedelta
from time import monotonic
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn
from rich.text import Text

LATE = 300  # episodes that success and collisions are of
NOT_KNOWN = "time left not known yet"


class TimesColumn(ProgressColumn):
    """The time since a task began, and what is left of a training."""

    max_refresh = 0.5  # s

    def render(self, task: Task) -> Text:
        """Return both in words: ``0:01:07 so far, 0:12:30 left``."""
        so_far = f"{timedelta(seconds=int(task.elapsed or 0.0))} so far"
        return Text(f"{so_far}, {task.fields['left']()}" if task.fields["left"] else so_far)


class TrainingReport(Progress):
    """A bar of steps with time left, level, success and collisions of late episodes, and one of what is done besides.

    Silent where there is no terminal.
    """

    def __init__(self, total_steps: int) -> None:
        columns: tuple[Any, ...] = (TextColumn("{task.description}"), BarColumn(bar_width=20), MofNCompleteColumn())
        columns += (TextColumn("{task.fields[said]}"), TimesColumn())
        super().__init__(*columns, console=Console(stderr=True), disable=not sys.stderr.isatty())
        self._steps = self.add_task(
            "training", total=total_steps, said="", left=self.time_left, start=False, visible=False
        )
        self._besides = self.add_task("", said="", left=None, visible=False)
        self._marks: list[tuple[float, int]] = []

    def start_side_task(self, what: str, total: int) -> None:
        """Show that something else is done, in so many parts, until all of them are."""
        self.reset(self._besides, description=what, total=total, visible=True)

    def update_side_task(self, done: int) -> None:
        """Show how many parts of it are done."""
        task = next(task for task in self.tasks if task.id == self._besides)
        self.update(self._besides, completed=done, visible=done < (task.total or 0.0))

    def begin(self, steps: int, total: int) -> None:
        """Show from where training goes on, and up to where; the time left counts from here."""
        self.reset(self._steps, completed=steps, total=total, visible=True)
        self._marks = []

    def mark(self, steps: int) -> None:
        """Take in that an update is over, or the first rollout begins: these the time left follows from."""
        self._marks.append((monotonic(), steps))

    def time_left(self) -> str:
        """Return the time left in words; the first rollout, in which kernels are compiled, does not count."""
        later = self._marks[1:]
        if len(later) < 2:
            return NOT_KNOWN
        (first, begun), (last, done) = later[0], later[-1]
        total = next(task.total for task in self.tasks if task.id == self._steps) or 0.0
        seconds = (last - first) / (done - begun) * (total - done) - (monotonic() - last)
        return f"{timedelta(seconds=max(0, round(seconds)))} left"

    def note(self, steps: int, late: RecentEpisodes, level: str) -> None:
        """Show how it stands; ``level`` is empty where there is none."""
        said = f"success {late.success:.2f} collisions {late.collisions:.2f}" if late.episodes else ""
        self.update(self._steps, completed=steps, description=f"training{level}", said=said)


class RecentEpisodes:
    """Success without collision, and collisions, of the latest training episodes."""

    def __init__(self) -> None:
        self._ends: deque[tuple[bool, int]] = deque(maxlen=LATE)

    def add(self, collisions: int, *, success: bool) -> None:
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
