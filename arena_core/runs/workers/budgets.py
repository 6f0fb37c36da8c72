"""What an episode may take before it is ended: budgets, and the watch that counts them."""

from __future__ import annotations

from dataclasses import dataclass

from arena_core.base.pulse import FINISHING, STARTING
from arena_core.values.parameters import Positive

GIGABYTE = 1e9  # bytes
BUILDING = 60.0  # s, at least, to build an episode in a warm worker: worlds and maps are no commands
# s that one look may add: whoever was asleep himself (Ctrl-Z, a suspended machine) blames no one for it
LONGEST_TICK = 1.0


@dataclass(frozen=True, slots=True)
class Budgets:
    """Wall time of the first command, of every later one, and of a whole episode, s; memory of a worker, GB. None:
    without end.

    The first counts from the moment that the worker takes the episode up: it builds, loads and compiles. A warm worker,
    which has driven with the same components and compiles nothing now, has no longer for it than for any other command.
    """

    first_command: Positive | None
    command: Positive | None
    episode: Positive | None
    memory: Positive | None


class Watch:
    """Counts what one episode has taken, from one look to the next."""

    def __init__(self, budgets: Budgets) -> None:
        self._budgets = budgets
        self._beats = STARTING
        self._since_beat = 0.0
        self._since_begin = 0.0

    def look(self, beats: int, passed: float, memory: int, *, warm: bool = False) -> str | None:
        """Return which budget is at its end, None if all are kept.

        ``beats`` is the count of control steps begun, ``passed`` the time since the last look (s), ``memory`` in bytes.
        """
        passed = min(passed, LONGEST_TICK)
        self._since_begin += passed
        self._since_beat = self._since_beat + passed if beats == self._beats else 0.0
        self._beats = beats
        return self._too_late(warm=warm) or self._too_large(memory)

    def _too_late(self, *, warm: bool) -> str | None:
        limit = self._time_limit(warm=warm)
        if limit is not None and self._since_beat > limit:
            return f"no {'first ' * (self._beats <= 1)}command within {limit:g} s"
        if self._budgets.episode is not None and self._since_begin > self._budgets.episode:
            return f"not over within {self._budgets.episode:g} s"
        return None

    def _time_limit(self, *, warm: bool) -> float | None:
        """Return how long the next control step may take to begin."""
        first, command = self._budgets.first_command, self._budgets.command
        if self._beats in (STARTING, FINISHING):
            return None
        if self._beats > 1 or not warm:
            return command if self._beats > 1 else first
        if command is None or first is None:
            return first if command is None else command
        return min(first, command if self._beats else max(command, BUILDING))

    def _too_large(self, memory: int) -> str | None:
        if self._budgets.memory is None or memory <= self._budgets.memory * GIGABYTE:
            return None
        return f"more than {self._budgets.memory:g} GB"
