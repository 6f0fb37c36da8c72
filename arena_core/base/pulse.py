"""Signs of life: what the episode in this process tells the process that supervises it, at every control step."""

from __future__ import annotations

from typing import Protocol

FINISHING = -1  # the last control step is over
STARTING = -2  # the process is not there yet


class Cell(Protocol):
    """A whole number that two processes may share, such as a ``multiprocessing.RawValue``."""

    value: int


class _Nobody:
    """The cell where no one watches."""

    value = 0


class Pulse:
    """The count of control steps begun; an episode is the process's, so there is one object of this class."""

    def __init__(self) -> None:
        self._cell: Cell = _Nobody()
        self._compiled: Cell = _Nobody()

    def share(self, beats: Cell, compiled: Cell) -> None:
        """Count in cells that the supervisor reads: control steps, and kernels that are compiled."""
        self._cell, self._compiled = beats, compiled

    def detach(self) -> None:
        """Count for no one: a forked child is not what is supervised."""
        self._cell, self._compiled = _Nobody(), _Nobody()

    def begin(self) -> None:
        """Say that an episode begins."""
        self._cell.value = 0

    def beat(self) -> None:
        """Say that a control step begins (a tenth of a microsecond: no clock, no system call)."""
        self._cell.value += 1

    def compile(self) -> None:
        """Say that a kernel begins to be compiled."""
        self._compiled.value += 1

    def compiled(self) -> int:
        """Return how many kernels have begun to be compiled."""
        return self._compiled.value

    def finish(self) -> None:
        """Say that no control step will follow."""
        self._cell.value = FINISHING


pulse = Pulse()
