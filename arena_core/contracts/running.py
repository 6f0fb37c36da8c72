"""The interfaces of a run: what is measured, who carries out its jobs, and what its users call."""

from __future__ import annotations

import math
import pathlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, TypeVar

from arena_core.values.episode import EpisodeRecord

T = TypeVar("T")
Better = Literal["higher", "lower", "neither"]  # what a reader wishes of a metric


@dataclass(frozen=True, slots=True)
class Metric:
    """One figure of an episode: ``compute(record)``, NaN where it is not defined. ``better`` is what a reader wishes
    for.

    What is true or false has the unit ``0/1``; a text has the unit ``text`` and is empty where it is not defined.
    ``path_metric`` marks figures that are reported over all *and* over successful episodes. No value lies outside
    ``bounds``, nor does the interval of their mean.
    """

    name: str
    unit: str
    better: Better
    description: str
    compute: Callable[[EpisodeRecord], float | str]
    path_metric: bool = False
    bounds: tuple[float, float] = (-math.inf, math.inf)


class MetricPack(ABC):
    """A named set of metrics: pure functions of an EpisodeRecord.

    Life cycle: built once in each process of a run, and by ``arena evaluate``; ``metrics`` is called once.

    Attributes:

    - ``bare``: whether columns are named as its metrics; else they begin with the pack's name and a dot. One pack of a
      run may be bare.

    ```python
    class Lengths(MetricPack):
        def metrics(self) -> Sequence[Metric]:
            return [Metric("steps", "steps", "lower", "control steps driven", lambda record: len(record["stamp"]))]
    ```
    """

    bare: bool = False

    @abstractmethod
    def metrics(self) -> Sequence[Metric]:
        """Return the metrics of this pack, in the order of their columns."""


@dataclass(frozen=True, slots=True)
class Job:
    """One episode to run: its run's composed configuration (plain containers), folder, number, and the
    level of a task that adapts.

    In a run of teams each of the ``robots`` has an episode of its own, numbered one after another: the job of any of
    them runs all.
    """

    config: Mapping[str, Any]
    folder: str
    episode: int
    stage: int | None = None
    robots: int = 1


@dataclass(frozen=True, slots=True, eq=False)
class Finished:
    """What came of a job: its row of ``episodes.csv``, and whether the episode succeeded, which
    a task that adapts goes by. ``team`` is what came of the other robots of a team.
    """

    job: Job
    row: Mapping[str, Any]
    succeeded: bool
    team: tuple[Finished, ...] = ()


@dataclass(frozen=True, slots=True)
class Lost:
    """A job that an executor could not bring to its end, and why, in one line."""

    job: Job
    reason: str


class Executor(ABC):
    """Runs jobs somewhere, in one call of ``map`` or several.

    Life cycle: ``prepare`` once with a job of each run, then ``map`` (again for each block of a task that adapts), at
    last ``close``. ``work`` is picklable and never raises for a failed episode; what it does raise, let through.

    ```python
    class OneByOne(Executor):
        def map(self, work: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
            return map(work, jobs)
    ```
    """

    @abstractmethod
    def map(self, work: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Yield what ``work`` returns of each job, in any order; ``Lost`` where it returns nothing."""

    def prepare(self, check: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Run the checks that come before any ``map``, one a run: in this process, unless an
        executor can protect it from them.
        """
        return (check(job) for job in jobs)

    def close(self) -> None:  # noqa: B027 - an executor that keeps nothing between two calls has nothing to give back
        """Give back what was kept warm from one ``map`` to the next."""


class Reporter(ABC):
    """Says what runs have shown: pages for people, comparisons for programs.

    Life cycle: made once for each report; the first one installed serves ``arena run`` and ``Runs.report``.
    """

    @abstractmethod
    def report(self, folders: Sequence[pathlib.Path], target: pathlib.Path, baseline: str | None = None) -> None:
        """Write tables, pictures and a page over all runs at or below the folders to
        ``target``, and print what matters.
        """

    @abstractmethod
    def compare(self, folders: Sequence[pathlib.Path], baseline: str | None = None) -> Sequence[Mapping[str, Any]]:
        """Return how each planner differs from the baseline on the same scenarios: a row for each
        planner, condition and metric.
        """


class Reference(ABC):
    """Finds out afterwards what could have been done in the problems of runs.

    Life cycle: built once by ``arena run``, before anything runs; ``refer`` is called once, when all episodes of all
    runs that chose it have ended, ahead of their report. It writes findings, and never into records.

    ```python
    class Lengths(Reference):
        def refer(self, folders: Sequence[pathlib.Path], executor: Mapping[str, Any]) -> None:
            print(f"{len(folders)} runs could be compared with something")
    ```
    """

    @abstractmethod
    def refer(self, folders: Sequence[pathlib.Path], executor: Mapping[str, Any]) -> None:
        """Write findings beside the records of these runs; ``executor`` is the configuration of what carries jobs.

        Called again for the same runs where they are resumed: what is known is kept.
        """


class Export(ABC):
    """Writes the records of a run in a form that other programs read: ``arena export RUN to=NAME``.

    Life cycle: made once for each call of ``arena export``.

    Attributes:

    - ``help``: what is written and who reads it, one line.
    - ``ending``: of the file that holds all episodes; empty where a folder holds a file for each.

    ```python
    class Sizes(Export):
        help = "how many episodes there are"
        ending = ".txt"

        def write(self, folder: pathlib.Path, target: pathlib.Path, episodes: Sequence[int]) -> None:
            target.write_text(f"{len(episodes)}")
    ```
    """

    help: ClassVar[str]
    ending: ClassVar[str]

    @abstractmethod
    def write(self, folder: pathlib.Path, target: pathlib.Path, episodes: Sequence[int]) -> None:
        """Write these episodes of the run in ``folder`` to ``target``, which is not there yet; raise ArenaError."""


class Listing(ABC):
    """Something beside components that ``arena list`` shows; made once for each call.

    ```python
    class Planets(Listing):
        def names(self) -> Sequence[str]:
            return ["earth", "mars"]

        def summary(self) -> Sequence[str]:
            return ["planets: 2"]

        def details(self) -> Sequence[str]:
            return self.names()
    ```
    """

    @abstractmethod
    def names(self) -> Sequence[str]:
        """Return what can be chosen."""

    @abstractmethod
    def summary(self) -> Sequence[str]:
        """Return a few lines for ``arena list``."""

    @abstractmethod
    def details(self) -> Sequence[str]:
        """Return the lines of ``arena list NAME``."""


class Command(ABC):
    """A subcommand of ``arena``; made once for each call.

    Attributes:

    - ``help``: one line for ``arena --help``.
    - ``checks``: the kind of options that ``arena check KIND=NAME`` has it check; empty: none.
    - ``kept``: printed when Ctrl-C ended it: what is not lost, and how it goes on. A note of the KeyboardInterrupt
      (``add_note``) is printed in its place, where that depends on when it came.

    ```python
    class Greet(Command):
        help = "greet a person: arena greet NAME"

        def run(self, arguments: Sequence[str]) -> int:
            print("hello", *arguments)
            return 0
    ```
    """

    help: ClassVar[str]
    kept: ClassVar[str] = ""
    checks: ClassVar[str] = ""

    @abstractmethod
    def run(self, arguments: Sequence[str]) -> int:
        """Run with the words after the command's name and return the exit status: 0 done, 1 failed, 2 refused.

        An ArenaError is printed as one line, with status 2.
        """

    def check(self, name: str, overrides: Sequence[str]) -> int:
        """Check the option ``name`` of the kind ``checks``, print what was found and return the exit status."""
        raise NotImplementedError

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return what the unfinished ``word`` after ``words`` can become, whole words; none: a
        shell offers the names of files.
        """
        return ()
