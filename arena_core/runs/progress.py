"""What a run says while it runs: a bar where there is a terminal, else a line now
and then, and every change of level.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Sequence
from datetime import timedelta
from time import monotonic
from types import TracebackType
from typing import Any, TypeVar

from arena_core.base.notices import activity
from arena_core.contracts.running import Finished, Job
from arena_core.runs.folders.schedule import Block, OpenRun
from arena_core.runs.pace import Pace

LINE_EVERY = 30.0  # s between two lines where there is no terminal
COUNT_EVERY = 2.0  # s between two lines of a count
Item = TypeVar("Item")


def print_progress(what: str, items: Sequence[Item]) -> Iterator[Item]:
    """Yield the items; print on standard error which of several is at hand, ``composing job 17
    of 36``: the first, then every 2 s.
    """
    last = -COUNT_EVERY
    for number, item in enumerate(items, 1):
        if len(items) > 1 and monotonic() >= last + COUNT_EVERY:
            last = monotonic()
            print(f"arena: {what} {number} of {len(items)}", file=sys.stderr, flush=True)
        yield item


class Progress:
    """Count the finished episodes of ``runs``, some of which may have been there before."""

    def __init__(self, runs: Sequence[OpenRun]) -> None:
        self._runs = runs
        self._told = [len(_ended_blocks(run)) for run in runs]
        self._kinds = {str(run.folder): Pace.kind(run.config) for run in runs}
        self._due: Counter[Hashable] = Counter()
        for run in runs:
            self._due[self._kinds[str(run.folder)]] += run.left()
        self._pace = Pace.of_run(runs[0].config if runs else {})
        self._bar = _make_bar(self._time_left) if sys.stderr.isatty() else None
        done, left = sum(len(run.rows) for run in runs), sum(run.left() for run in runs)
        self._task = (
            self._bar.add_task("episodes", total=done + left, completed=done, successes="-") if self._bar else None
        )
        self._before, self._all = done, done + left
        self._successes = 0
        self._seen = 0
        self._last_line = monotonic()

    def __enter__(self) -> Progress:
        if self._bar:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar:
            self._bar.stop()

    def begin(self, jobs: Sequence[Job]) -> None:
        """Begin a round of jobs and name its levels."""
        levels = sorted({job.stage for job in jobs if job.stage is not None})
        if self._bar and self._task is not None and levels:
            self._bar.update(self._task, description=f"level {', '.join(map(str, levels))}")

    def add(self, finished: Finished) -> None:
        """Take in a finished episode, which its run has already."""
        self._seen += 1
        self._successes += finished.succeeded
        now, kind = monotonic(), self._kinds[finished.job.folder]
        self._pace.add(kind, now)
        self._due[kind] -= 1
        if self._bar and self._task is not None:
            self._bar.update(self._task, advance=1, successes=f"{self._successes}/{self._seen}")
        elif now > self._last_line + LINE_EVERY and any(self._due.values()):
            self._last_line = now
            print(f"arena: {self._status_text()}", file=sys.stderr, flush=True)

    def _status_text(self) -> str:
        """Return how far the run is: ``12 of 50 episodes, 9 of 12 succeeded, about 48 s left``."""
        left = self._time_left()
        said = f"{self._before + self._seen} of {self._all} episodes, {self._successes} of {self._seen} succeeded"
        return f"{said}, {'time left not known yet' if left is None else f'about {left:.0f} s left'}"

    def _time_left(self) -> float | None:
        return self._pace.left(self._due, monotonic())

    def end(self) -> None:
        """End a round: say what became of the blocks that ended in it."""
        for i, run in enumerate(self._runs):
            ended = _ended_blocks(run)
            for block in ended[self._told[i] :]:
                print(f"{run.folder.name}: " * (len(self._runs) > 1) + _block_line(run, block))
            self._told[i] = len(ended)


def _ended_blocks(run: OpenRun) -> list[Block]:
    return [block for block in run.blocks() if block.ended]


def _block_line(run: OpenRun, block: Block) -> str:
    """Return what a block's end means: ``level 2, episodes 40 .. 59: 18 of 20 succeeded, on to level 3``."""
    succeeded = [run.successes[i] for i in block.episodes]
    said = (
        f"level {block.stage}, episodes {block.episodes[0]} .. {block.episodes[-1]}: "
        f"{sum(succeeded)} of {len(succeeded)} succeeded"
    )
    if run.staging is None or len(succeeded) < run.staging.block:
        return said
    following = run.staging.next(block.stage, succeeded)
    move = (
        "stays" if following == block.stage else f"{'on' if following > block.stage else 'back'} to level {following}"
    )
    return f"{said}, {move}"


def _make_bar(left: Callable[[], float | None]) -> Any:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, ProgressColumn, TextColumn
    from rich.progress import Progress as RichProgress
    from rich.text import Text

    class TimeLeft(ProgressColumn):
        max_refresh = 0.5

        def render(self, task: Any) -> Text:
            seconds = left()
            if activity.doing:
                return Text(activity.doing)
            return Text("time left not known yet" if seconds is None else f"{timedelta(seconds=round(seconds))} left")

    return RichProgress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("success {task.fields[successes]}"),
        TimeLeft(),
        console=Console(stderr=True),
    )
