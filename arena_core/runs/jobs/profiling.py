"""Where the time of control steps goes: CPU time of each part of a run, in compiled functions,
in libraries and in Python.
"""

from __future__ import annotations

import cProfile
import pstats
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from types import ModuleType
from typing import Any, TypeVar

from arena_core.config.plugins import enabled_entry_points
from arena_core.runs.jobs.benchmark import Benchmark
from arena_core.runs.jobs.rows import evaluate_record

T = TypeVar("T")
Place = tuple[str, int, str]  # file, line, function: as the profiler names it
REST = "loop"
TASK, METRICS = "task", "metrics"  # once an episode; all others once a control step or less


@dataclass(frozen=True, slots=True)
class Spent:
    """CPU time of one part, s: all of it, and what of it went into compiled functions and into
    libraries; the rest is Python.
    """

    cpu: float
    compiled: float
    libraries: float

    @property
    def python(self) -> float:
        """What is neither compiled nor a library's."""
        return max(0.0, self.cpu - self.compiled - self.libraries)


@dataclass(frozen=True, slots=True)
class Called:
    """A function of the suite or of a plugin: where it stands, how often it was called, its own CPU time without those
    it calls, s.

    Times of Python functions are the profiler's, which makes them longer.
    """

    place: Place
    compiled: bool
    calls: int
    own: float


@dataclass(frozen=True, slots=True)
class Profile:
    """So many episodes and control steps, s simulated, what each part took, and the functions that took most."""

    episodes: int
    steps: int
    simulated: float
    parts: Mapping[str, Spent]
    functions: Sequence[Called]


def profile_benchmark(benchmark: Benchmark, episodes: int, announce: Callable[[str], None] = lambda _: None) -> Profile:
    """Run the first episodes three times: to compile and fill caches, to time, and to look
    inside; each is announced.
    """
    with TemporaryDirectory() as folder:
        announce("1 of 3: compiling what is not compiled yet, and filling caches")
        _run_watched(benchmark, episodes, Path(folder), Clock())
        clock, looking = Clock(), Profilers()
        announce("2 of 3: timing")
        steps, simulated = _run_watched(benchmark, episodes, Path(folder), clock)
        announce("3 of 3: looking inside")
        _run_watched(benchmark, episodes, Path(folder), looking)
    tables = {part: pstats.Stats(profiler) for part, profiler in looking.profilers.items()}
    inside = {part: table.stats for part, table in tables.items()}  # type: ignore[attr-defined]
    compiled, own = compiled_places(), own_folders()
    parts = {part: _split_time(cpu, inside.get(part, {}), compiled, own) for part, cpu in clock.spent.items()}
    in_steps = [functions for part, functions in inside.items() if part not in (TASK, METRICS)]
    return Profile(episodes, steps, simulated, parts, _slowest_functions(in_steps, compiled, own))


@dataclass(slots=True)
class Clock:
    """Adds up the CPU time of the parts of a run; a part that runs inside another one is its own."""

    spent: dict[str, float] = field(default_factory=dict)
    _within: float = 0.0

    @contextmanager
    def part(self, name: str) -> Iterator[None]:
        """Count what happens inside for this part."""
        outside, self._within = self._within, 0.0
        began = process_time()
        try:
            yield
        finally:
            took = process_time() - began
            self.spent[name] = self.spent.get(name, 0.0) + took - self._within
            self._within = outside + took


@dataclass(slots=True)
class Profilers:
    """Keeps a profiler for each part; one of them looks at a time."""

    profilers: dict[str, cProfile.Profile] = field(default_factory=dict)
    _stack: list[cProfile.Profile] = field(default_factory=list)

    @contextmanager
    def part(self, name: str) -> Iterator[None]:
        """Let the profiler of this part look at what happens inside."""
        profiler = self.profilers.setdefault(name, cProfile.Profile())
        if self._stack:
            self._stack[-1].disable()
        self._stack.append(profiler)
        profiler.enable()
        try:
            yield
        finally:
            profiler.disable()
            self._stack.pop()
            if self._stack:
                self._stack[-1].enable()


def compiled_places() -> set[Place]:
    """Return where the functions stand that numba compiles, or another compiler that keeps the Python function as
    ``py_func``.

    Each of them in two places: as it is called through its dispatcher, and as the code that a dispatcher gives out.
    """
    modules = [vars(module) for module in list(sys.modules.values()) if isinstance(module, ModuleType)]
    functions = [
        function
        for module in modules
        for value in list(module.values())
        if hasattr(function := _python_of(value), "__code__")
    ]
    codes = [function.__code__ for function in functions]
    entries = {("~", 0, f"<built-in method {function.__module__}.{function.__name__}>") for function in functions}
    return {(code.co_filename, code.co_firstlineno, code.co_name) for code in codes} | entries


def _python_of(value: Any) -> Any:
    """Return the Python function of a compiled one, None for all else; nothing is asked of a
    value that it could hear.
    """
    try:
        return object.__getattribute__(value, "__dict__").get("py_func")
    except AttributeError:
        return None


def own_folders() -> list[str]:
    """Return the folders of the core and of every plugin's package, and of the suite's packages that they share."""
    names = {"arena_core", *(point.module.partition(".")[0] for point in enabled_entry_points())}
    names |= {name for name in sys.modules if name.startswith("arena_") and "." not in name}
    packages = [sys.modules[name] for name in sorted(names) if name in sys.modules]
    return [str(Path(package.__file__).parent) for package in packages if package.__file__]


def _run_watched(benchmark: Benchmark, episodes: int, folder: Path, watch: Clock | Profilers) -> tuple[int, float]:
    """Run and evaluate episodes, watched; return how many control steps there were, and how many seconds they are."""
    steps, simulated = 0, 0.0
    with _watch_components(benchmark, watch), watch.part(REST):
        for episode in range(episodes):
            record = benchmark.run(episode, folder)
            with watch.part(METRICS):
                evaluate_record(record, benchmark.metrics)
            steps, simulated = steps + len(record["stamp"]) - 1, simulated + float(record["stamp"][-1])
    return steps, simulated


@contextmanager
def _watch_components(benchmark: Benchmark, watch: Clock | Profilers) -> Iterator[None]:
    """Watch the calls of every component's methods, each as a part of its own."""
    robot = benchmark.navigator
    methods = {
        TASK: (benchmark.task, ("scenario",)),
        "simulator": (benchmark.simulator, ("reset", "advance")),
        "localizer": (robot.localizer, ("reset", "update")),
        "global planner": (robot.global_planner, ("plan", "cost")),
        "waypoints": (robot.waypoints, ("reset", "next")),
        "local map": (robot.local_map, ("reset", "update", "clear", "planning_grid")),
        "tracker": (robot.tracker, ("reset", "update")),
        "predictor": (robot.predictor, ("reset", "predict")),
        "planner": (robot.planner, ("reset", "compute_velocity")),
    }
    for part, (component, names) in methods.items():
        for name in names:
            vars(component)[name] = _in_part(watch, part, getattr(component, name))
    try:
        yield
    finally:
        for component, names in methods.values():
            for name in names:
                del vars(component)[name]


def _in_part(watch: Clock | Profilers, part: str, method: Callable[..., T]) -> Callable[..., T]:
    def watched(*arguments: Any, **named: Any) -> T:
        with watch.part(part):
            return method(*arguments, **named)

    return watched


def _split_time(cpu: float, functions: Mapping[Place, Any], compiled: set[Place], own: Sequence[str]) -> Spent:
    times = {place: own_time for place, (_, _, own_time, _, _) in functions.items()}
    within_compiled = sum(time for place, time in times.items() if place in compiled)
    within_libraries = sum(time for place, time in times.items() if place not in compiled and not _is_own(place, own))
    return Spent(cpu, within_compiled, within_libraries)


def _slowest_functions(parts: Any, compiled: set[Place], own: Sequence[str]) -> list[Called]:
    """Return the functions of the suite and of plugins, those that took most first."""
    calls, times = Counter[Place](), Counter[Place]()
    for functions in parts:
        for place, (_, called, own_time, _, _) in functions.items():
            if place in compiled or _is_own(place, own):
                calls[place] += called
                times[place] += own_time
    return [
        Called(place, place in compiled, calls[place], time)
        for place, time in times.most_common()
        if place[0] != __file__
    ]


def _is_own(place: Place, folders: Sequence[str]) -> bool:
    return any(place[0].startswith(folder) for folder in folders)
