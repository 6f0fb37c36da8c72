"""Plant faults in the code, one at a time, and count those that the tests find.

usage: .venv/bin/python benchmarks/mutants.py [AREA ...] [--seed N] [--share X] [--retry] [--compiled] [--table]

A fault is planted in a copy of the tree, below build/mutants. Tests run there with kernels as plain Python: those that
execute the changed line first, the fastest of them first, until one fails. Results are lines of
build/mutants/results.jsonl; a later call goes on from there and leaves out what was killed. ``--retry`` tries survivors
again although no test has changed, ``--compiled`` with compiled kernels as well, by the tests that need these (minutes
each). ``--share`` takes that part of the mutants, and ``--table`` prints what is known and runs nothing.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mutation import Mutant, find_mutants

HERE = Path(__file__).resolve().parents[1]
WORK = HERE / "build" / "mutants"
COPY, RESULTS = WORK / "tree", WORK / "results.jsonl"
SLOWEST, TOGETHER = 4.0, 60.0  # [s] of processor time of one test, of all that look at one mutant
PATIENCE = 30.0  # [s] beyond three times what the tests take, after which a mutant counts as killed
COMPILED = 240  # [s] of processor time for the tests with compiled kernels: most of it compiles
MEMORY = 6 << 30  # bytes
PLAIN = {"ARENA_KERNELS": "plain", "NUMBA_DISABLE_JIT": "1"}
SHARED = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
LIBRARIES = ("numpy", "numba", "scipy.special", "scipy.stats", "matplotlib.pyplot", "statsmodels.stats.api")
TOOLS = ("hypothesis", "coverage", "pytest", "hydra", "omegaconf", "pluggy", "rich.console")
QUIET = (
    "-q",
    "-x",
    "--no-header",
    "-p",
    "no:cacheprovider",
    "-p",
    "no:cov",
    "-p",
    "no:xdist",
    "-m",
    "not long",
    "-W",
    "ignore::pytest.PytestAssertRewriteWarning",
)


@dataclass(frozen=True, slots=True)
class Area:
    """Modules and the tests that look at them, as patterns, and how many mutants are drawn.

    ``compiled``: the tests only pass with compiled kernels, for rows of tables have their fields as attributes there
    alone.
    """

    count: int
    modules: Sequence[str]
    tests: Sequence[str]
    without: Sequence[str] = ()
    compiled: bool = False


def _of(package: str, *names: str) -> list[str]:
    return [f"plugins/arena-{package}/src/arena_{package}/{name}.py" for name in names]


AREAS: Mapping[str, Area] = {
    "statistics": Area(
        36,
        ["arena_core/statistics/*.py"],
        [
            "tests/statistics/test_*.py",
            "plugins/arena-metrics/tests/test_intervals.py",
            "plugins/arena-metrics/tests/test_paired_differences.py",
            "plugins/arena-metrics/tests/test_comparison_sentences.py",
            "plugins/arena-metrics/tests/test_ranking.py",
        ],
    ),
    "rewards": Area(
        32,
        [
            *_of("gym", "progress_reward", "release_reward", "switch_reward"),
            *_of("gring", "reward"),
            *_of("cadrl", "reward", "training/returns"),
        ],
        [
            "plugins/arena-gym/tests/test_*reward*.py",
            "plugins/arena-gring/tests/test_*reward*.py",
            "plugins/arena-cadrl/tests/test_cadrl_values.py",
            "plugins/arena-cadrl/tests/test_cadrl_reward*.py",
        ],
    ),
    "ranking": Area(
        22,
        [
            *_of("metrics", "tables/ranking", "tables/pairs", "tables/comparison_sentences"),
            "plugins/arena-metrics/src/arena_submit/leaderboard.py",
            "plugins/arena-metrics/src/arena_submit/cards.py",
        ],
        [
            "plugins/arena-metrics/tests/test_ranking.py",
            "plugins/arena-metrics/tests/test_paired_differences.py",
            "plugins/arena-metrics/tests/test_comparison_sentences.py",
            "plugins/arena-metrics/tests/submit/test_ranks.py",
        ],
    ),
    "metrics": Area(
        42,
        _of("metrics", "claims/*", "packs/*", "pooling/*"),
        ["plugins/arena-metrics/tests/test_*.py"],
        ["*interval_coverage*", "*pictures*", "*sim_to_real*", "*test_report*", "*replays*", "*levels*", "*query*"],
    ),
    "kernels": Area(
        48,
        ["plugins/arena-kernels/src/arena_kernels/*.py"],
        ["plugins/arena-kernels/tests/test_*.py"],
        ["*compiled*", "*typed_dispatch*", "*scalars*"],
    ),
    "simulator": Area(
        22,
        _of(
            "sim2d",
            *("bodies", "broad_phase", "clearances", "contact", "motion", "motion_step"),
            *("obstacles", "odometry", "substeps", "walking"),
        ),
        [
            f"plugins/arena-sim2d/tests/test_sim2d_{name}.py"
            for name in ("absence", "broad_phase", "contact", "furniture", "legs", "motion", "sensing")
        ],
        compiled=True,
    ),
    "costs": Area(
        48,
        [
            *_of("dwa", "approach", "arrival", "map_grid", "obstacles", "search", "turning"),
            *_of("mppi", "critics", "own_critics", "cost_to_go", "weights", "path_following"),
            *_of("teb", "terms", "feasibility"),
            *_of("mpc", "objective", "terms", "moving"),
            *_of("orca", "preferred_velocity", "gear_changes", "braking"),
        ],
        [
            *(f"plugins/arena-dwa/tests/test_dwa_{name}.py" for name in ("approach", "arrival", "map_grid")),
            *(f"plugins/arena-dwa/tests/test_{name}.py" for name in ("dwa_obstacles", "dwa_critics", "turning")),
            *(f"plugins/arena-mppi/tests/test_{name}.py" for name in ("mppi_critics", "path_following", "cost_to_go")),
            "plugins/arena-mppi/tests/test_mppi_optimizer.py",
            *(f"plugins/arena-teb/tests/test_teb_{name}.py" for name in ("terms", "obstacles", "solver")),
            *(f"plugins/arena-mpc/tests/test_mpc_{name}.py" for name in ("terms", "parts", "shooting")),
            "plugins/arena-orca/tests/test_*.py",
        ],
    ),
}


@dataclass(frozen=True, slots=True)
class Planted:
    """A mutant, the module it is in and the source of that."""

    area: str
    module: str
    source: bytes
    mutant: Mutant

    @property
    def key(self) -> str:
        """Return what tells this mutant from all others."""
        digest = hashlib.sha256(self.source).hexdigest()[:12]
        return f"{self.module}@{digest}:{self.mutant.start}-{self.mutant.end}:{self.mutant.after}"

    @property
    def line(self) -> int:
        """Return the number of the line that is changed."""
        return self.source[: self.mutant.start].count(b"\n") + 1


@dataclass(frozen=True, slots=True)
class Looked:
    """What the tests of one file do without a fault: seconds of each that passes, and who executes which line."""

    file: str
    seconds: Mapping[str, float]
    lines: Mapping[str, Mapping[str, Sequence[str]]]  # tests by line by module
    compiled: bool  # whether some tests do not pass with plain kernels


def main() -> None:
    """Draw mutants, run the tests on them, and print how many were killed."""
    asked = _arguments()
    _prepare()
    for name in asked.areas or AREAS:
        drawn = draw_mutants(name, asked.seed, asked.share)
        if not asked.table:
            _run_area(name, drawn, retry=asked.retry or asked.compiled, compiled=asked.compiled)
        _print_table(name, drawn)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("areas", nargs="*", metavar="AREA", help=", ".join(AREAS))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--share", type=float, default=1.0)
    parser.add_argument("--retry", action="store_true")
    parser.add_argument("--compiled", action="store_true")
    parser.add_argument("--table", action="store_true")
    asked = parser.parse_args()
    if unknown := [name for name in asked.areas if name not in AREAS]:
        parser.error(f"no area {unknown[0]}; allowed: {', '.join(AREAS)}")
    return asked


def draw_mutants(area: str, seed: int, share: float = 1.0) -> list[Planted]:
    """Return the mutants of an area that a seed draws, in the order of the modules."""
    every = []
    for path in _matching(AREAS[area].modules, AREAS[area].without):
        source = (COPY / path).read_bytes()
        every += [Planted(area, path, source, mutant) for mutant in find_mutants(source)]
    count = min(len(every), round(AREAS[area].count * share))
    shuffled = random.Random(f"{seed} {area}").sample(every, len(every))  # so that fewer are the first of more
    return sorted(shuffled[:count], key=lambda one: (one.module, one.mutant.start, one.mutant.after))


def _matching(patterns: Sequence[str], without: Sequence[str] = ()) -> list[str]:
    found = {path.relative_to(COPY) for pattern in patterns for path in COPY.glob(pattern)}
    return sorted(str(path) for path in found if not any(path.match(pattern) for pattern in without))


def _prepare() -> None:
    """Copy the tree, which may change meanwhile, and load libraries that every process that is forked from here has."""
    shutil.rmtree(COPY, ignore_errors=True)
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=HERE, capture_output=True)
    for name in filter(None, listed.stdout.decode().split("\0")):
        if (HERE / name).is_file():
            (COPY / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(HERE / name, COPY / name)
    shared = WORK / "shared"
    if (HERE.parent / "shared").is_dir() and not shared.exists():
        shared.symlink_to(HERE.parent / "shared")
    sources = [str(COPY), *map(str, sorted(COPY.glob("plugins/*/src")))]
    os.environ |= {**PLAIN, **SHARED, "PYTHONPATH": os.pathsep.join(sources)}
    sys.path[:0] = sources
    for name in (*LIBRARIES, *TOOLS):
        __import__(name)


def _run_area(name: str, drawn: Sequence[Planted], *, retry: bool, compiled: bool) -> None:
    files = _matching(AREAS[name].tests, AREAS[name].without)
    looked = [] if AREAS[name].compiled else [_look(name, file) for file in files]
    known = read_results()
    for planted in drawn:
        tests, slow = _tests_of(planted, looked), _compiled_tests(planted, looked) if compiled else []
        slow = files if AREAS[name].compiled else slow
        stamp = hashlib.sha256("".join((COPY / file).read_text() for file in _files([*tests, *slow])).encode())
        before = known.get(planted.key)
        if before and (before["state"] != "survived" or (before["tests"] == stamp.hexdigest() and not retry)):
            continue
        result = {**_try_mutant(planted, tests, slow), "tests": stamp.hexdigest()}
        with RESULTS.open("a") as file:
            file.write(json.dumps({"key": planted.key, "area": name, **result}) + "\n")
        print(result["state"], f"{planted.module}:{planted.line}", _change_text(planted), result["by"], flush=True)


def _files(tests: Sequence[str]) -> list[str]:
    return sorted({test.partition("::")[0] for test in tests})


def read_results() -> dict[str, dict[str, Any]]:
    """Return what is known of each mutant, by its key."""
    lines = RESULTS.read_text().splitlines() if RESULTS.exists() else []
    return {one["key"]: one for one in map(json.loads, lines)}


def _tests_of(planted: Planted, looked: Sequence[Looked]) -> list[str]:
    """Return the tests that look at a mutant: those that execute its lines, then those of files that use its module."""
    first: dict[str, float] = {}
    others: dict[str, float] = {}
    for one in looked:
        lines = one.lines.get(planted.module, {})
        if not any(tests for tests in lines.values()):
            continue
        direct = {test for line in planted.mutant.lines for test in lines.get(str(line), ())}
        first |= {test: one.seconds[test] for test in direct if test in one.seconds}
        others |= {test: seconds for test, seconds in one.seconds.items() if test not in direct}
    chosen, total = [], 0.0
    for test, seconds in [*sorted(first.items(), key=lambda t: t[1]), *sorted(others.items(), key=lambda t: t[1])]:
        total += seconds
        if total <= TOGETHER:
            chosen.append(test)
    return chosen


def _compiled_tests(planted: Planted, looked: Sequence[Looked]) -> list[str]:
    """Return the files with tests that need compiled kernels, of those that use the mutant's module."""
    return [one.file for one in looked if one.compiled and any(one.lines.get(planted.module, {}).values())]


def _try_mutant(planted: Planted, tests: Sequence[str], slow: Sequence[str]) -> dict[str, Any]:
    begun = time.monotonic()
    target = COPY / planted.module
    target.write_bytes(planted.mutant.plant(planted.source))
    os.utime(target, ns=(time.time_ns(), time.time_ns()))
    target.with_name("__pycache__").is_dir() and shutil.rmtree(target.with_name("__pycache__"))
    try:
        state, by = _run_plain(tests) if tests else ("survived", "")
        if state == "survived" and slow:
            state, by = _run_compiled(slow)
    finally:
        target.write_bytes(planted.source)
        os.utime(target, ns=(time.time_ns(), time.time_ns()))
        shutil.rmtree(target.with_name("__pycache__"), ignore_errors=True)
    found = {"module": planted.module, "line": planted.line, "before": planted.mutant.before}
    return {
        **found,
        **{"after": planted.mutant.after, "state": state, "by": by, "looked": len(tests) or len(slow)},
        "seconds": round(time.monotonic() - begun, 1),
    }


def _run_plain(tests: Sequence[str]) -> tuple[str, str]:
    """Return whether tests find a mutant, and which of them did."""
    said = WORK / "said.json"
    said.unlink(missing_ok=True)
    status = _fork(lambda: _pytest_only(tests, said), 3.0 * TOGETHER + PATIENCE)
    if status is None:
        return "killed", "time limit"
    by = json.loads(said.read_text()) if said.exists() else "no start"
    return ("survived", "") if status == 0 else ("killed", by)


def _run_compiled(files: Sequence[str]) -> tuple[str, str]:
    environment = {name: value for name, value in os.environ.items() if name not in PLAIN}
    command = [sys.executable, "-m", "pytest", *QUIET, *files]
    done = subprocess.run(
        command, cwd=COPY, env=environment, capture_output=True, text=True, preexec_fn=_limit_processor_time
    )
    if done.returncode == -signal.SIGXCPU:
        return "killed", "time limit"
    failed = [line.split()[1] for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return ("survived", "") if done.returncode == 0 else ("killed", (failed or ["no start"])[0])


def _limit_processor_time() -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (COMPILED, COMPILED))


def _fork(work: Any, limit: float) -> int | None:
    """Do work in a process of its own; return its exit status, None where it took too long."""
    child = os.fork()
    if child == 0:
        os.setpgid(0, 0)
        os.chdir(COPY)
        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
        with (WORK / "output.txt").open("w") as out:
            os.dup2(out.fileno(), 1)
            os.dup2(out.fileno(), 2)
        status = 70
        try:
            status = int(work())
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status)
    until = time.monotonic() + limit
    while time.monotonic() < until:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.02)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None


def _pytest_only(tests: Sequence[str], said: Path) -> int:
    import pytest

    places = {test: place for place, test in enumerate(tests)}

    class Chosen:
        @pytest.hookimpl(trylast=True)
        def pytest_collection_modifyitems(self, items: list[Any]) -> None:
            items[:] = sorted((item for item in items if item.nodeid in places), key=lambda item: places[item.nodeid])

        def pytest_runtest_logreport(self, report: Any) -> None:
            if report.failed:
                said.write_text(json.dumps(report.nodeid))

        def pytest_collectreport(self, report: Any) -> None:
            if report.failed:
                said.write_text(json.dumps(report.nodeid))

    return pytest.main([*QUIET, *_files(tests)], plugins=[Chosen()])


def _look(area: str, file: str) -> Looked:
    """Run the tests of one file without a fault, or read what they did the last time."""
    watched = _matching(AREAS[area].modules, AREAS[area].without)
    conftests = [path for folder in (COPY / file).parents for path in [folder / "conftest.py"] if path.is_file()]
    stamp = hashlib.sha256(repr((area, SLOWEST)).encode())
    for path in [COPY / file, *conftests, *(COPY / module for module in watched)]:
        stamp.update(path.read_bytes())
    kept = WORK / "looks" / f"{Path(file).stem}-{stamp.hexdigest()[:16]}.json"
    if not kept.exists():
        kept.parent.mkdir(parents=True, exist_ok=True)
        status = _fork(lambda: _pytest_traced(file, watched, kept), 1200.0)
        print("looked at", file, "exit status", status, flush=True)
    return Looked(file, **(json.loads(kept.read_text()) if kept.exists() else _nothing()))


def _nothing() -> dict[str, Any]:
    return {"seconds": {}, "lines": {}, "compiled": True}


def _pytest_traced(file: str, watched: Sequence[str], kept: Path) -> int:
    import coverage
    import pytest

    tracer = coverage.Coverage(data_file=None, include=[str(COPY / module) for module in watched], config_file=False)
    seconds: dict[str, float] = {}
    failed: set[str] = set()

    class Traced:
        @pytest.hookimpl(wrapper=True)
        def pytest_runtest_protocol(self, item: Any) -> Iterator[None]:
            tracer.switch_context(item.nodeid)
            signal.setitimer(signal.ITIMER_PROF, SLOWEST)
            try:
                return (yield)
            finally:
                signal.setitimer(signal.ITIMER_PROF, 0.0)
                tracer.switch_context("")

        def pytest_runtest_logreport(self, report: Any) -> None:
            seconds[report.nodeid] = seconds.get(report.nodeid, 0.0) + report.duration
            if not report.passed:
                failed.add(report.nodeid)

    signal.signal(signal.SIGPROF, _raise_timeout)
    tracer.start()
    status = pytest.main([word for word in (*QUIET, file) if word != "-x"], plugins=[Traced()])
    tracer.stop()
    data = tracer.get_data()
    lines = {
        str(Path(name).relative_to(COPY)): {
            str(line): sorted(filter(None, contexts)) for line, contexts in data.contexts_by_lineno(name).items()
        }
        for name in data.measured_files()
    }
    passing = {test: round(took, 3) for test, took in seconds.items() if test not in failed}
    kept.write_text(json.dumps({"seconds": passing, "lines": lines, "compiled": bool(failed)}))
    return status


def _raise_timeout(*_: object) -> None:
    raise TimeoutError(f"more than {SLOWEST:g} s")


def _change_text(planted: Planted) -> str:
    return f"`{' '.join(planted.mutant.before.split())}` → `{planted.mutant.after}`"


def _print_table(area: str, drawn: Sequence[Planted]) -> None:
    known = read_results()
    met = [(planted, known[planted.key]) for planted in drawn if planted.key in known]
    survivors = [(planted, one) for planted, one in met if one["state"] == "survived"]
    print(f"\n{area}: {len(met)} of {len(drawn)} mutants tried, {len(met) - len(survivors)} killed")
    for planted, one in survivors:
        print(f"  {planted.module}:{planted.line} {_change_text(planted)} ({one['looked']} tests) {one['by']}")


if __name__ == "__main__":
    main()
