"""The problems that a planner is tuned on: three sets with disjoint seeds, as configuration describes them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Annotated, Any, Literal

from arena_core import ConfigurationError, InputFileError
from arena_core.commands import key_value
from arena_core.files import option_files, read_yaml
from arena_core.hosting import Registry
from arena_core.parameters import Bounds, NonNegativeInt, PositiveInt, read_settings

GROUP = "problems"
ALLOWED = "a set of problems as in docs/tuning.md"
Purpose = Literal["tune", "validate", "test"]


@dataclass(frozen=True, slots=True)
class SearchSet:
    """Whose seed the problems are drawn with that values are searched on."""

    seed: NonNegativeInt


@dataclass(frozen=True, slots=True)
class JudgingSet:
    """The seed and number of problems on which values are compared."""

    seed: NonNegativeInt
    problems: PositiveInt


@dataclass(frozen=True, slots=True)
class ProblemSets:
    """Three sets of problems, and how sets of values race on those of ``tune``: so many ``entrants`` at a time, of
    which losers are dropped after each of ``blocks``, numbers of problems.
    """

    version: PositiveInt
    words: list[str]
    cells: list[list[str]]
    entrants: Annotated[int, Bounds(low=2, high=1000)]
    blocks: list[PositiveInt]
    tune: SearchSet
    validate: JudgingSet
    test: JudgingSet

    @property
    def searched(self) -> int:
        """Return how many problems values are searched on."""
        return self.blocks[-1]

    @property
    def before_last(self) -> int:
        """Return how many of these come before the last block."""
        return self.blocks[-2] if len(self.blocks) > 1 else 0

    def seed(self, purpose: Purpose) -> int:
        """Return the seed of one of the sets."""
        return {"tune": self.tune.seed, "validate": self.validate.seed, "test": self.test.seed}[purpose]

    def facts(self, name: str) -> dict[str, Any]:
        """Return what a card says of the sets."""
        return {"name": name, **asdict(self)}


@dataclass(frozen=True, slots=True)
class Problem:
    """One problem of a set: episode ``number`` of one of its cells."""

    purpose: Purpose
    cell: int
    number: int


def read_problem_sets(name: str, registry: Registry) -> ProblemSets:
    """Read the sets of problems of a name; raise ConfigurationError or InputFileError (one line)."""
    files = option_files(GROUP, registry.manager)
    if name not in files:
        raise ConfigurationError(f"problems is {name}; allowed: {', '.join(files)}, or a file of your conf folder")
    content = read_yaml(str(files[name]), ALLOWED)
    try:
        found = read_settings(content, ProblemSets, "")
    except ConfigurationError as error:
        raise InputFileError(f"{files[name]}: {str(error).strip()}; allowed: {ALLOWED}") from None
    if fault := _fault_of(found):
        raise InputFileError(f"{files[name]}: {fault}")
    return found


def _fault_of(sets: ProblemSets) -> str:
    if not sets.cells:
        return "cells is empty; allowed: a list of words at least, which may be empty"
    if not sets.blocks or any(later <= before for before, later in pairwise(sets.blocks)):
        return f"blocks is {sets.blocks}; allowed: numbers that grow"
    seeds = (sets.tune.seed, sets.validate.seed, sets.test.seed)
    if len(set(seeds)) < len(seeds):
        return f"seeds are {seeds}; allowed: another one for each set"
    return ""


def problems_of(sets: ProblemSets, purpose: Purpose, count: int) -> list[Problem]:
    """Return the first problems of a set, which alternate between its cells."""
    cells = len(sets.cells)
    return [Problem(purpose, index % cells, index // cells) for index in range(count)]


def words_of(sets: ProblemSets, cell: int, chosen: Sequence[str]) -> list[str]:
    """Return the words that compose a cell: those of the sets, with the user's in the place of those for the same
    keys, and of what lies below a group that the user chose.
    """
    given = dict(map(key_value, chosen))
    return [word for word in (*sets.words, *sets.cells[cell]) if not _is_replaced(key_value(word)[0], given)]


def _is_replaced(key: str, given: Mapping[str, str]) -> bool:
    return any(above in given for above in _keys_above(key))


def _keys_above(key: str) -> Iterator[str]:
    while key:
        yield key
        key = key.rpartition(".")[0]
