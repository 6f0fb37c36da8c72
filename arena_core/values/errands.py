"""Errands: robots of a team that are sent from place to place for as long as an episode lasts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

from arena_core.values.geometry import FloatArray

NextPlace = Callable[[int, float], int]  # where robot m, which is at its place at a stamp (s), is sent: a number


class Errands(ABC):
    """Where the robots of a team are sent: each is bound for the place that its scenario calls its goal, and once it is
    there for another one, until the time limit.

    ``kind`` is the word for it in records, ``places`` (V, 2) are in ``map``, m, ``bound_for`` (M,) the numbers of those
    that robots are bound for at first.
    """

    kind: str
    places: FloatArray
    bound_for: tuple[int, ...]

    @abstractmethod
    def begin(self) -> NextPlace:
        """Begin an episode; return what says where a robot is sent that is where it was sent before."""


@dataclass(frozen=True, slots=True, eq=False)
class PatrolGraph:
    """What is patrolled: ``places`` (V, 2) in ``map``, m, and ``lengths`` (V, V) m of the ways between neighbours, inf
    where two places are none. All places are connected.
    """

    places: FloatArray
    lengths: FloatArray

    def __len__(self) -> int:
        return len(self.places)
