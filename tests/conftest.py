"""Fixtures: the command line within this process, and small third-party packages made on the spot."""

from __future__ import annotations

import csv
import json
import os
import re
import signal
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from textwrap import dedent

import pytest
from hypothesis import HealthCheck, settings

from arena_core.cli.main import main
from arena_core.config.plugins import _load_manager
from arena_core.hosting import load_registry
from arena_core.records import read_record
from arena_core.runs.jobs.code_digest import _digest_code
from arena_core.runs.jobs.compiling import NOTICE
from arena_core.runs.jobs.working import _cached_benchmark, _load_registry

settings.register_profile("suite", derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
settings.load_profile("suite")


# what a cold or slow machine says besides
BUSY = re.compile(rf"arena: ({NOTICE}|\d+ of \d+ episodes, |composing job \d+ of \d+$)")


@dataclass(frozen=True)
class Answer:
    """What a command said: exit status, standard output, and the lines of standard error."""

    status: int
    out: str
    errors: list[str]

    @property
    def line(self) -> str:
        """Return the one line of standard error; fail when there are more or fewer."""
        assert len(self.errors) == 1, self.errors
        return self.errors[0]


def of_the_suite(kind: str) -> list[str]:
    """Return the installed names of a kind that the suite brings; whoever runs the tests may
    have plugins of others beside it.
    """
    registry = load_registry()
    return [
        name for name in registry.names(kind) if registry.component(kind, name).distribution()[0].startswith("arena-")
    ]


@pytest.fixture
def arena(
    request: pytest.FixtureRequest, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> Iterator[Callable[..., Answer]]:
    """Call ``arena WORDS...`` in this process, from an empty folder.

    Plugins and what they were found to be made of are kept, but for tests that write packages of their own.
    """
    own = "third_party" in request.fixturenames
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    monkeypatch.setenv("HYDRA_FULL_ERROR", "1")  # the command sets it: let pytest take it back afterwards

    def call(*words: object) -> Answer:
        _forget_plugins(own=own)
        capfd.readouterr()
        status = main([str(word) for word in words])
        out, err = capfd.readouterr()
        return Answer(status, out, [line for line in err.splitlines() if not BUSY.match(line)])

    yield call
    _forget_plugins(own=own)


def _forget_plugins(*, own: bool) -> None:
    _load_registry.cache_clear()
    _cached_benchmark.cache_clear()
    if own:
        _load_manager.cache_clear()
        _digest_code.cache_clear()


@dataclass(frozen=True)
class ThirdParty:
    """A folder on the module search path, for packages that look installed."""

    folder: Path

    def package(self, name: str, module: str, conf: Mapping[str, str] | None = None, version: str = "1.2.3") -> None:
        """Write a plugin package with its distribution's metadata; ``conf`` maps group/option to YAML."""
        self.write(f"{name}/__init__.py", module)
        self.write(f"{name}-{version}.dist-info/METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
        self.write(f"{name}-{version}.dist-info/entry_points.txt", f"[arena]\n{name} = {name}\n")
        if conf is not None:
            self.write(f"{name}/conf/__init__.py", "")
        for option, text in (conf or {}).items():
            self.write(f"{name}/conf/{option}.yaml", text)

    def write(self, path: str, text: str) -> None:
        """Write one file below the folder."""
        (self.folder / path).parent.mkdir(parents=True, exist_ok=True)
        (self.folder / path).write_text(dedent(text))

    @property
    def environment(self) -> dict[str, str]:
        """Return the environment in which another process sees the packages too."""
        return {**os.environ, "PYTHONPATH": str(self.folder)}


@pytest.fixture
def third_party(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ThirdParty]:
    """Offer an empty site folder to write third-party packages into."""
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", str(folder))
    yield ThirdParty(folder)
    for name in [n for n, m in sys.modules.items() if str(getattr(m, "__file__", "") or "").startswith(str(folder))]:
        del sys.modules[name]


FAULTY = 4  # the episode that a fault befalls
TEN = (
    *("planner=misbehaving", "robot=jackal", "world=empty", "world.width=8", "world.height=8", "task.pedestrians=0"),
    *("localizer=ground_truth", "report=false", "episodes=10"),
)
# those of time are for faults that hang: a machine may be busy
BUDGETS = ("executor.budgets.command=20", "executor.budgets.memory=1")


@dataclass(frozen=True)
class Kept:
    """What a run left: its rows by episode, without what depends on the wall clock, and its records by name."""

    rows: dict[int, dict[str, str]]
    records: dict[str, bytes]

    @classmethod
    def of(cls, folder: str) -> Kept:
        """Read a run's folder."""
        with Path(folder, "episodes.csv").open(newline="") as file:
            rows = {
                int(row["episode"]): {k: v for k, v in row.items() if not k.startswith("planning_")}
                for row in csv.DictReader(file)
            }
        return cls(rows, {path.name: path.read_bytes() for path in sorted(Path(folder, "records").glob("*"))})


@dataclass(frozen=True)
class Misbehaving:
    """Ten short episodes with ``tests/planners/misbehaving.py``; a fault befalls the fifth alone, or others that are
    said.

    ``whole`` is the run without one, ``goals`` are those of its episodes.
    """

    arena: Callable[..., Answer]
    monkeypatch: pytest.MonkeyPatch
    whole: Kept
    goals: list[str]

    def run(self, folder: str, *words: str, fault: str = "", moment: str = "") -> Answer:
        """Run with a fault."""
        self.befall(fault, moment)
        return self.arena("run", *self.words(folder), *words)

    def run_alone(self, folder: str, *words: str) -> Answer:
        """Run in this process, without a fault: who drives does not matter."""
        self.befall("", "")
        usual = [word for word in self.words(folder) if not word.startswith("executor.budgets")]
        return self.arena("run", *usual, "executor=serial", *words)

    def words(self, folder: str) -> list[str]:
        """Return what the command line says of such a run."""
        return [*TEN, *BUDGETS, f"hydra.run.dir={folder}"]

    def befall(self, fault: str, moment: str) -> None:
        """Let the next run have a fault, in whatever process it is."""
        self.befall_each({FAULTY: (fault, moment)} if fault else {})

    def befall_each(self, faults: Mapping[int, tuple[str, str]]) -> None:
        """Let the next run have faults in several episodes, each at its moment."""
        told = [(self.goals[episode], fault, moment) for episode, (fault, moment) in faults.items()]
        self.monkeypatch.setenv("FAULTS", json.dumps(told))


_whole: list[tuple[Kept, list[str]]] = []  # made once in a session


@pytest.fixture
def misbehaving(third_party: ThirdParty, arena: Callable[..., Answer], monkeypatch: pytest.MonkeyPatch) -> Misbehaving:
    """Offer the misbehaving planner, and what it does when it behaves."""
    planner = Path(__file__).with_name("planners") / "misbehaving.py"
    third_party.package("misbehaving", planner.read_text(), {"planner/misbehaving": "name: misbehaving\n"})
    if not _whole:
        assert arena("run", *TEN, "executor=serial", "hydra.run.dir=reference").status == 0
        goals = [read_record(path).meta["scenario"]["goal"] for path in sorted(Path("reference/records").iterdir())]
        _whole.append((Kept.of("reference"), [f"{x:.6f} {y:.6f}" for x, y, _ in goals]))
    return Misbehaving(arena, monkeypatch, *_whole[0])


@pytest.fixture
def ctrl_c() -> Iterator[None]:
    """Let Ctrl-C be heard, though a shell that runs the tests in the background has it ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
