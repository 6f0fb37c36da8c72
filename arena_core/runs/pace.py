"""How long the episodes that are left may take, by when others ended: no word of it until there are enough of them."""

from __future__ import annotations

import json
import os
from collections import defaultdict
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from math import sqrt
from typing import Any

LEAST = 4  # times between two ends of a kind of episode that an estimate needs
SURE = 1.0 / 3.0  # standard error of their mean, at most, to that mean
APART = ("seed", "episodes", "code", "executor", "report")  # keys by which episodes do not differ in how long they take


@dataclass(slots=True)
class _Kind:
    """How many episodes of a kind have ended, and how many times between two ends count, with their sum (s) and that of their squares."""

    ended: int = 0
    counted: int = 0
    seconds: float = 0.0
    squares: float = 0.0

    def add(self, seconds: float) -> None:
        self.counted += 1
        self.seconds += seconds
        self.squares += seconds * seconds

    def mean(self) -> float | None:
        """Return the time between two ends, s, None where it is not sure enough."""
        if self.counted < LEAST:
            return None
        mean = self.seconds / self.counted
        spread = sqrt(max(0.0, self.squares / self.counted - mean * mean) / (self.counted - 1))
        return mean if spread <= SURE * mean else None


class Pace:
    """The time between the ends of episodes that ``workers`` drive at once, kind by kind.

    The first ends of each kind do not count, one for each worker: until then workers start, build, load and compile.
    """

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._kinds: defaultdict[Hashable, _Kind] = defaultdict(_Kind)
        self._last: float | None = None

    @classmethod
    def of_run(cls, config: Mapping[str, Any]) -> Pace:
        """Return the pace of a run of this configuration, before anything has ended."""
        return cls(config.get("executor", {}).get("workers", 1) or os.cpu_count() or 1)

    @staticmethod
    def kind(config: Mapping[str, Any]) -> Hashable:
        """Return what episodes have in common that take alike, of the configuration of their run."""
        return json.dumps({key: value for key, value in config.items() if key not in APART}, sort_keys=True, default=str)

    def add(self, kind: Hashable, time: float) -> None:
        """Take in that an episode ended at this time, s, not before the one before."""
        one = self._kinds[kind]
        if self._last is not None and one.ended >= self._workers:
            one.add(time - self._last)
        one.ended += 1
        self._last = time

    def left(self, episodes: Mapping[Hashable, int], time: float) -> float | None:
        """Return how long, from this time on, so many episodes of each kind may take, s; None where there is no ground for a guess."""
        due = {kind: number for kind, number in episodes.items() if number > 0}
        means = {kind: self._kinds[kind].mean() if kind in self._kinds else None for kind in due}
        total = 0.0
        for kind, mean in means.items():
            if mean is None:
                return None
            total += due[kind] * mean
        waited = time - self._last if self._last is not None else 0.0
        return total - min(waited, total / max(1, sum(due.values())))
