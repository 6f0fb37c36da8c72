"""How long the episodes that are left may take, by when others ended: no word of it until there are enough of them."""

from __future__ import annotations

import json
import os
from collections import defaultdict, deque
from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from math import ceil, sqrt
from statistics import fmean, stdev
from typing import Any

LEAST = 4  # times between two ends of a kind of episode that an estimate needs
SURE = 0.3  # standard error of their mean, at most, to that mean
KEPT = 300  # of these times at most, of which the latest two thirds count: at first machines are busy with what starts
APART = (
    "seed",
    "episodes",
    "code",
    "executor",
    "report",
    "reference",
)  # keys by which episodes do not take longer or shorter


@dataclass(slots=True)
class _Kind:
    """How many episodes of a kind have ended, and the times between two ends, s."""

    ended: int = 0
    times: deque[float] = field(default_factory=lambda: deque(maxlen=KEPT))

    def mean(self, workers: int) -> float | None:
        """Return the time between two ends, s, None where it is not sure enough.

        How sure it is follows from the times in which ``workers`` episodes end: workers that begin together end
        together.
        """
        least = max(LEAST, workers + 2)
        latest = list(self.times)[-max(least, ceil(len(self.times) * 2 / 3)) :]
        if len(latest) < least:
            return None
        rounds = [sum(latest[first : first + workers]) for first in range(len(latest) - workers + 1)]
        sure = stdev(rounds) <= SURE * fmean(rounds) * sqrt(len(latest) / workers)
        return fmean(latest) if sure else None


class Pace:
    """The time between the ends of episodes that ``workers`` drive at once, kind by kind.

    The first ends of each kind do not count, two for each worker: until then workers start, build, load and compile,
    and those that have compiled are replaced.
    """

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._kinds: defaultdict[Hashable, _Kind] = defaultdict(_Kind)
        self._last: float | None = None

    @classmethod
    def of_run(cls, config: Mapping[str, Any]) -> Pace:
        """Return the pace of a run of this configuration, before anything has ended."""
        executor = config.get("executor")
        workers = executor.get("workers") if isinstance(executor, Mapping) else 1
        return cls(workers if isinstance(workers, int) and workers > 0 else os.cpu_count() or 1)

    @staticmethod
    def kind(config: Mapping[str, Any]) -> Hashable:
        """Return what episodes have in common that take alike, of the configuration of their run."""
        return json.dumps(
            {key: value for key, value in config.items() if key not in APART}, sort_keys=True, default=str
        )

    def add(self, kind: Hashable, time: float) -> None:
        """Take in that an episode ended at this time, s, not before the one before."""
        one = self._kinds[kind]
        if self._last is not None and one.ended >= 2 * self._workers:
            one.times.append(time - self._last)
        one.ended += 1
        self._last = time

    def left(self, episodes: Mapping[Hashable, int], time: float) -> float | None:
        """Return how long, from this time on, so many episodes of each kind may take, s; None
        where there is no ground for a guess.
        """
        due = {kind: number for kind, number in episodes.items() if number > 0}
        means = {kind: self._kinds[kind].mean(self._workers) if kind in self._kinds else None for kind in due}
        total = 0.0
        for kind, mean in means.items():
            if mean is None:
                return None
            total += due[kind] * mean
        waited = time - self._last if self._last is not None else 0.0
        return total - min(waited, total / max(1, sum(due.values())))
