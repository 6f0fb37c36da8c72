"""What a training says while it runs: lines everywhere, on a terminal a bar of steps, too, and
one of what is done besides.
"""

from __future__ import annotations

import sys
from collections import deque
from datetime import timedelta
from time import monotonic
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn
from rich.text import Text

from arena_gym.training.time_left import EvaluationLength, ImitationPace, Pace, RewardsPace

LATE = 300  # episodes that success and collisions are of
NOT_KNOWN = "time left not known yet"


class TimesColumn(ProgressColumn):
    """The time since a task began, and what is left of its phase."""

    max_refresh = 0.5  # s

    def render(self, task: Task) -> Text:
        """Return both in words: ``0:01:07 so far, 0:12:30 left``."""
        so_far = f"{timedelta(seconds=int(task.elapsed or 0.0))} so far"
        return Text(f"{so_far}, {task.fields['left']()}" if task.fields["left"] else so_far)


def left_text(seconds: float | None, of: str = "") -> str:
    """Return a time left in words: ``0:12:30 left``, ``0:12:30 left of all lessons``."""
    if seconds is None:
        return NOT_KNOWN
    return f"{timedelta(seconds=max(0, round(seconds)))} left" + (f" {of}" if of else "")


class EvaluationProgress:
    """Shows how far a validation or the test is, and how long it may go on; ``earlier`` are lengths of the episodes of
    the last one.
    """

    def __init__(self, report: TrainingReport, earlier: list[int]) -> None:
        self._report, self._earlier = report, earlier
        self._pace = Pace()
        self._begun = self._last = monotonic()
        self._length = EvaluationLength(np.zeros(0, np.int64))
        self._left: tuple[float, float] | None = None  # s, and when that was worked out

    def begin(self, quota: NDArray[np.int64]) -> None:
        """Take in how many episodes each world drives."""
        self._length = EvaluationLength(quota, self._earlier)

    def step(self, ended: NDArray[np.bool_]) -> None:
        """Take in that all worlds have made a step, and which episodes ended with it."""
        now = monotonic()
        self._pace.add(now - self._last, 1.0)
        self._last = now
        self._length.step(ended)
        self._report.update_side_task(len(self._length.lengths))

    @property
    def lengths(self) -> list[int]:
        """Return the lengths of the episodes that have ended, in steps."""
        return self._length.lengths

    def times(self) -> tuple[float, float] | None:
        """Return how long it may take as a whole, and what is left of that, s; None where that cannot be told yet."""
        now = monotonic()
        if self._left is None or now - self._left[1] > TimesColumn.max_refresh:
            steps = self._length.left()
            seconds = None if steps is None else self._pace.seconds(steps)
            self._left = None if seconds is None else (seconds, now)
        if self._left is None:
            return None
        return now - self._begun + self._left[0], self._left[0]


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
        self._rewards = RewardsPace(0, total_steps, total_steps)
        self._evaluation: EvaluationProgress | None = None
        self._lengths: list[int] = []

    def start_side_task(self, what: str, total: int) -> None:
        """Show that something else is done, in so many parts, until all of them are."""
        self.reset(self._besides, description=what, total=total, visible=True, left=None)

    def start_lesson(self, lesson: int, rounds: int, pace: ImitationPace, decisions: int) -> None:
        """Show that a lesson of so many decisions begins, the first being 1, and how long all may go on."""
        self.start_side_task(f"lesson {lesson} of {rounds}, decisions", decisions)
        task = next(task for task in self.tasks if task.id == self._besides)

        def left() -> str:
            return left_text(pace.left(lesson, int(task.completed)), "of all lessons")

        self.update(self._besides, left=left)

    def start_evaluation(self, what: str, episodes: int) -> EvaluationProgress:
        """Show that so many episodes are driven, and return what hears of them."""
        self.start_side_task(what, episodes)
        evaluation = self._evaluation = EvaluationProgress(self, self._lengths)

        def left() -> str:
            times = evaluation.times()
            return left_text(None if times is None else times[1])

        self.update(self._besides, left=left)
        return evaluation

    def end_validation(self, seconds: float) -> None:
        """Take in that the validation under way is over, and how long it took."""
        self._rewards.validate(seconds)
        self._lengths = [] if self._evaluation is None else self._evaluation.lengths
        self._evaluation = None

    def update_side_task(self, done: int) -> None:
        """Show how many parts of it are done."""
        task = next(task for task in self.tasks if task.id == self._besides)
        self.update(self._besides, completed=done, visible=done < (task.total or 0.0))

    def begin(self, steps: int, total: int, every: int) -> None:
        """Show from where training goes on, and up to where; a validation is due every so many steps."""
        self.reset(self._steps, completed=steps, total=total, visible=True)
        self._rewards = RewardsPace(steps, total, every)

    def begin_rollout(self) -> None:
        """Take in that a rollout begins; the first, in which kernels are compiled, is no measure."""
        self._rewards.begin_rollout(monotonic())

    def end_rollout(self, steps: int) -> None:
        """Take in that a rollout and its update are over, after so many steps."""
        self._rewards.end_rollout(monotonic(), steps)

    def time_left(self) -> str:
        """Return how long learning from rewards may go on, in words."""
        found = self._rewards.left(monotonic(), None if self._evaluation is None else self._evaluation.times())
        return NOT_KNOWN if found is None else left_text(found[0], "" if found[1] else "but for validations")

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
