"""Recorded episodes driven again, by the commands that were sent then."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from arena_core import ArenaError, EpisodeRecord, Scenario, Simulator, Snapshot
from arena_core.hosting import Benchmark, CommandQueue

TRUE_TO = 1e-5  # m, to which the robot drives again as recorded


class RecordDiffers(ArenaError):
    """An episode that does not come out here as its record says."""


@dataclass(frozen=True, slots=True, eq=False)
class Driven:
    """Worlds side by side in ``simulator`` as they are at ``snapshot``; the first is the one that was recorded."""

    simulator: Simulator
    snapshot: Snapshot


def scenario_of(benchmark: Benchmark, episode: int, stage: object) -> Scenario:
    """Return the problem of an episode, on the level of a task that adapts; ``stage`` as a row of a run has it."""
    fixed = str(stage) in ("", "nan", "None")
    task = benchmark.task if fixed else benchmark.task.at_stage(int(float(str(stage))))
    return task.scenario(benchmark.settings.seed, episode)


def control_ticks(benchmark: Benchmark) -> int:
    """Return how many ticks of the simulator a control step has."""
    return round(benchmark.navigator.control_period / benchmark.simulator.inner_step)


def redrive(benchmark: Benchmark, record: EpisodeRecord, driven: Driven) -> Iterator[Snapshot]:
    """Drive the recorded commands in all worlds and yield what is at each row of the record, the last one too.

    Raises RecordDiffers where the robot of the first comes elsewhere than recorded.
    """
    simulator, snapshot = driven.simulator, driven.snapshot
    worlds, rows = len(snapshot.stamps), len(record["stamp"])
    queue, delay = CommandQueue(worlds), 0
    if benchmark.timing.mode == "latency":
        delay = math.ceil(benchmark.timing.latency / simulator.inner_step - 1e-9)
    for row in range(rows):
        off = float(np.abs(snapshot.poses[0, :2] - record["pose"][row, :2]).max())
        if off > TRUE_TO:
            raise RecordDiffers(
                f"the episode does not come out as recorded ({off:.3g} m off after {snapshot.stamps[0]:.1f} s); "
                "allowed: a record of this code, with timing.mode ideal or latency"
            )
        yield snapshot
        if row == rows - 1:
            return
        queue.send(np.repeat(record["command"][row][None], worlds, axis=0), np.full(worlds, delay))
        for commands, passed in queue.segments(control_ticks(benchmark)):
            snapshot = simulator.advance(commands, passed)
