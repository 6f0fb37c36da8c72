"""What each part of a control step takes: wall and CPU time, a part that another one asks for
counted once, as its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from time import perf_counter, process_time
from typing import NamedTuple, Protocol, TypeVar

T = TypeVar("T")


class Duration(NamedTuple):
    """Seconds by the clock on the wall, and of the processor, all threads of the process together."""

    wall: float
    cpu: float


NOTHING = Duration(0.0, 0.0)


class Timed(Protocol):
    """Run ``compute`` as the part of this name and return what it returns."""

    def __call__(self, part: str, compute: Callable[[], T]) -> T: ...  # noqa: D102 (above)


class Stopwatch:
    """Times the named parts of one control step, wherever they are called from."""

    def __init__(self) -> None:
        self._spent: dict[str, Duration] = {}
        self._within = NOTHING  # what parts inside the running one have taken so far

    @property
    def spent(self) -> Mapping[str, Duration]:
        """Return what each part has taken, without the parts that it called."""
        return self._spent

    def timed(self, part: str, compute: Callable[[], T]) -> T:
        """Return what ``compute`` returns; what it takes counts for this part, less the parts that run inside it."""
        (wall, cpu), self._within = self._within, NOTHING
        began = _current_time()
        try:
            return compute()
        finally:
            ended, before, within = _current_time(), self._spent.get(part, NOTHING), self._within
            took_wall, took_cpu = ended.wall - began.wall, ended.cpu - began.cpu
            self._spent[part] = Duration(before.wall + took_wall - within.wall, before.cpu + took_cpu - within.cpu)
            self._within = Duration(wall + took_wall, cpu + took_cpu)


def _current_time() -> Duration:
    return Duration(perf_counter(), process_time())
