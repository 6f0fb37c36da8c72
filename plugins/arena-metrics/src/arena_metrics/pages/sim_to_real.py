"""``arena compare-real``: the same problems in simulation and in reality, side by side and in pairs."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from arena_core import ArenaError, EpisodeRecord
from arena_core.commands import Command, align_columns, split_out
from arena_core.files import csv_text, write_text_whole
from arena_core.records import read_record
from arena_core.statistics import Comparison, after_holm, compare
from arena_metrics.one_thread import on_one_thread
from arena_metrics.packs.motion import polyline_length
from arena_metrics.pooling.path_similarity import FloatArray, discrete_frechet

if TYPE_CHECKING:
    from arena_metrics.pooling.runs import Column, Episode, Run
    from arena_metrics.tables.tables import Table

SAME_PLACE = 0.5  # m that start and goal of one problem may differ between simulation and reality, where names do
SPACING = 0.1  # m between the points of paths whose distance is taken
METRICS = {
    "path_length": "m",
    "time_to_goal": "s",
    "velocity": "m/s",
    "jerk": "m/s^3",
    "clearance_min": "m",
    "clearance_people_min": "m",
}


@dataclass(frozen=True, slots=True, eq=False)
class RecordedDrive:
    """One episode: its record, the metrics of its row (NaN where one is empty), and the row itself."""

    record: EpisodeRecord
    metrics: Mapping[str, float]
    episode: Episode | None = None

    @property
    def name(self) -> str:
        """Return the problem's name."""
        return str(self.record.meta["scenario"]["name"])

    @property
    def driver(self) -> tuple[str, str]:
        """Return who drove which robot."""
        row = {} if self.episode is None else self.episode.row
        return str(row.get("planner", "")), str(row.get("robot", ""))

    def is_comparable(self, other: RecordedDrive) -> bool:
        """Return whether the same planner drove the same robot, and both began and were to end at the same places."""
        if self.driver != other.driver:
            return False
        ends = (
            (self.record.meta["scenario"][key][:2], other.record.meta["scenario"][key][:2]) for key in ("start", "goal")
        )
        return all(math.dist(mine, theirs) <= SAME_PLACE for mine, theirs in ends)


@dataclass(frozen=True, slots=True, eq=False)
class SimRealPair:
    """One problem in simulation and in reality; ``frechet`` m between the paths."""

    simulated: RecordedDrive
    real: RecordedDrive
    frechet: float


class CompareRealCommand(Command):
    """Compare a run of the simulation with one of a real robot."""

    help: ClassVar[str] = "simulation beside reality: arena compare-real SIM_RUN REAL_RUN [out=DIR]"

    @on_one_thread
    def run(self, arguments: Sequence[str]) -> int:
        """Print a table of problems, one of differences, and verdicts on claims; with
        out=DIR write them and the paths.
        """
        from arena_metrics.pooling.runs import metric_columns, read_runs

        words, out = split_out(arguments)
        usage = "arena compare-real SIM_RUN REAL_RUN [out=DIR] [--claims NAME]"
        place = "out=DIR: where tables (CSV) and the picture of the paths are written"
        parser = argparse.ArgumentParser("arena compare-real", usage=usage, description=self.__doc__, epilog=place)
        parser.add_argument("simulated", metavar="SIM_RUN")
        parser.add_argument("real", metavar="REAL_RUN")
        parser.add_argument(
            "--claims", metavar="NAME", help="say which claims of a source hold: reality, or a file of your own"
        )
        given = parser.parse_args(words)
        simulated, real = read_runs([Path(given.simulated)]), read_runs([Path(given.real)])
        pairs = pair_drives(read_drives(simulated), read_drives(real))
        tables = {"problems": problem_rows(pairs), "differences": difference_rows(pairs)}
        for rows in tables.values():
            print("\n".join([*align_columns(rows), ""]))
        if given.claims:
            judged = judged_claims(pairs, metric_columns([*simulated, *real]), given.claims)
            tables["claims"] = [list(judged.head), *map(list, judged.rows)]
            print("\n".join(f"{row[1]}: {row[0]}\n  {row[2]}" for row in judged.rows))
        if out:
            _write_tables(Path(out), tables, pairs)
        return 0


def read_drives(runs: Sequence[Run]) -> list[RecordedDrive]:
    """Return the episodes of runs that have a record."""
    from arena_metrics.pooling.runs import pool_episodes

    return [
        RecordedDrive(
            read_record(episode.record_path),
            {name: float(episode.row.get(name, math.nan)) for name in METRICS},
            episode,
        )
        for episode in pool_episodes(runs)[0]
        if episode.record_path.exists()
    ]


def pair_drives(simulated: Sequence[RecordedDrive], real: Sequence[RecordedDrive]) -> list[SimRealPair]:
    """Pair episodes by the names of their problems, else by start and goal; raise ArenaError
    where none are of one problem.
    """
    left, found = list(simulated), []
    for drive in real:
        same = [one for one in left if one.name == drive.name and one.is_comparable(drive)] or [
            one for one in left if one.is_comparable(drive)
        ]
        if same:
            left.remove(same[0])
            found.append(SimRealPair(same[0], drive, discrete_frechet(_spaced_path(same[0]), _spaced_path(drive))))
    if not found:
        raise ArenaError(
            f"no problem is in both runs; allowed: runs whose starts and goals are within {SAME_PLACE} m (`arena "
            "ros scenario-from`)"
        )
    return found


def problem_rows(pairs: Sequence[SimRealPair]) -> list[list[str]]:
    """Return a table of problems, its first row the head: simulation / reality of each metric."""
    head = ["problem", "frechet m", *(f"{name} {unit}" for name, unit in METRICS.items())]
    rows = [
        [
            pair.real.name,
            f"{pair.frechet:.2f}",
            *(f"{pair.simulated.metrics[m]:.2f} / {pair.real.metrics[m]:.2f}" for m in METRICS),
        ]
        for pair in pairs
    ]
    return [head, *rows]


def difference_rows(pairs: Sequence[SimRealPair]) -> list[list[str]]:
    """Return a table of mean differences, reality less simulation, with 95 % intervals over the
    pairs in which both are defined.
    """
    found = after_holm([_compare_metric(pairs, name) for name in METRICS])
    head = ["reality less simulation", "mean", "from", "to", "n", "p (Holm)"]
    rows = [
        [f"{name} {unit}", *(f"{value:.3g}" for value in (e.mean, e.low, e.high)), str(e.n), f"{one.holm:.2g}"]
        for (name, unit), one in zip(METRICS.items(), found, strict=True)
        for e in (one.difference,)
    ]
    return [head, *rows]


def _compare_metric(pairs: Sequence[SimRealPair], name: str) -> Comparison:
    return compare([pair.real.metrics[name] for pair in pairs], [pair.simulated.metrics[name] for pair in pairs])


def _spaced_path(drive: RecordedDrive) -> FloatArray:
    """Return the path with points at even distances, from the place that both have as their start."""
    positions = drive.record["pose"][:, :2]
    steps = np.hypot(*np.diff(positions, axis=0).T)
    along = np.concatenate(([0.0], np.cumsum(steps)))
    points = np.linspace(0.0, along[-1], max(math.ceil(polyline_length(positions) / SPACING), 1) + 1)
    return np.stack([np.interp(points, along, positions[:, axis]) for axis in (0, 1)], axis=1)


def judged_claims(pairs: Sequence[SimRealPair], columns: Sequence[Column], name: str) -> Table:
    """Return what the pairs say of a source's claims, in which the factor ``simulator`` is ``simulation`` or
    ``reality``.

    Of each pair the real episode counts as one of the simulated one's condition and scenario, so that claims find the
    pair.
    """
    from arena_metrics.claims.claim_verdicts import claims_table, judge_claims
    from arena_metrics.claims.model import read_claims
    from arena_metrics.pooling.cells import FACTORS, cells_of

    episodes = []
    for pair in pairs:
        mine, real = pair.simulated.episode, pair.real.episode
        assert mine is not None
        assert real is not None
        shared = {
            key: mine.row[key]
            for key in (*FACTORS, "scenario", "scenario_hash", "seed", "episode", "stage")
            if key in mine.row
        }
        for one, side in ((mine, "simulation"), (real, "reality")):
            named = {**shared, "simulator": side, "config_hash": f"{mine.row['config_hash']} {side}", "code": ""}
            if side == "reality" and real.row.get("localizer"):
                named["localizer"] = real.row["localizer"]
            episodes.append(replace(one, row={**one.row, **named}))
    claims = read_claims(name)
    return claims_table(judge_claims(cells_of(episodes), columns, claims), claims.source)


def _write_tables(folder: Path, tables: Mapping[str, Sequence[Sequence[str]]], pairs: Sequence[SimRealPair]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, rows in tables.items():
        write_text_whole(folder / f"{name}.csv", csv_text(rows))
    _draw_pairs(folder / "paths.png", pairs)


def _draw_pairs(target: Path, pairs: Sequence[SimRealPair]) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    columns = min(len(pairs), 4)
    rows = math.ceil(len(pairs) / columns)
    figure = Figure(figsize=(4.0 * columns, 3.6 * rows), layout="constrained")
    FigureCanvasAgg(figure)
    for place, pair in enumerate(pairs):
        axes = figure.add_subplot(rows, columns, place + 1)
        for drive, label, style in ((pair.simulated, "simulation", "-"), (pair.real, "reality", "--")):
            axes.plot(*drive.record["pose"][:, :2].T, style, label=label)
        axes.plot(*pair.real.record.meta["scenario"]["goal"][:2], "k*")
        axes.set_aspect("equal", "datalim")
        axes.set_title(f"{pair.real.name}: Fréchet {pair.frechet:.2f} m", fontsize=9)
        axes.set(xlabel="x [m]", ylabel="y [m]")
    figure.axes[0].legend(fontsize=8)
    figure.savefig(target, dpi=120)
