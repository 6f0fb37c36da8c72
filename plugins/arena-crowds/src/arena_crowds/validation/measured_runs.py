"""Episodes for `arena crowd measure`: beside a robot that stands, many at once, or that a planner drives."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from arena_core import ABSENT, EpisodeRecord, Scenario
from arena_core.files import write_bytes_whole
from arena_core.hosting import Benchmark, build_benchmark, compose, load_registry, to_plain
from arena_core.records import record_path
from arena_crowds.validation.phases import Phased
from arena_crowds.validation.walk_record import WalkRecord

SAMPLE = 0.2  # s between instants beside a robot that stands
MOST_EPISODES = 10_000


@dataclass(frozen=True, slots=True)
class Extent:
    """How much is measured: ``episodes`` of ``seconds`` each beside a standing robot, or driven
    episodes for ``minutes`` in all.
    """

    episodes: int
    seconds: float
    minutes: float


def benchmark_of(overrides: Sequence[str], *, phased: bool) -> Benchmark:
    """Build a run from its overrides; ``phased`` lets people start elsewhere on their rounds in each episode."""
    benchmark = build_benchmark(to_plain(compose(list(overrides))), load_registry())
    return replace(benchmark, task=Phased(benchmark.task)) if phased else benchmark


def standing_episodes(benchmark: Benchmark, extent: Extent) -> list[WalkRecord]:
    """Return what people do round a robot that stands at its start."""
    seed, simulator = benchmark.settings.seed, benchmark.simulator
    scenarios = [benchmark.task.scenario(seed, number) for number in range(extent.episodes)]
    ticks, still = round(SAMPLE / simulator.inner_step), np.zeros((len(scenarios), 3))
    moments = [simulator.reset(scenarios)]
    moments += [simulator.advance(still, ticks) for _ in range(round(extent.seconds / SAMPLE))]
    stamps, poses = np.array([moment.stamps for moment in moments]), np.array([moment.poses for moment in moments])
    positions, states = (
        np.array([moment.crowd.positions for moment in moments]),
        np.array([moment.crowd.states for moment in moments]),
    )
    people = [len(scenario.pedestrians) for scenario in scenarios]
    return [
        WalkRecord(scenario, stamps[:, k], poses[:, k], positions[:, k, : people[k]], states[:, k, : people[k]])
        for k, scenario in enumerate(scenarios)
    ]


def driven_episodes(benchmark: Benchmark, extent: Extent, folder: Path) -> list[WalkRecord]:
    """Return episodes that the planner drives, so many that they last ``extent.minutes`` in all."""
    walked: list[WalkRecord] = []
    while sum(each.minutes for each in walked) < extent.minutes and len(walked) < MOST_EPISODES:
        number = len(walked)
        scenario = benchmark.task.scenario(benchmark.settings.seed, number)
        walked.append(_of_record(scenario, benchmark.run(number, folder)))
    return walked


def _of_record(scenario: Scenario, record: EpisodeRecord) -> WalkRecord:
    people = len(scenario.pedestrians)
    states = record.arrays.get("pedestrian_states", np.full(record["pedestrian_positions"].shape[:2], ABSENT))
    return WalkRecord(
        scenario, record["stamp"], record["pose"], record["pedestrian_positions"][:, :people], states[:, :people]
    )


def save_episodes(walked: Sequence[WalkRecord], folder: Path) -> None:
    """Write each episode to ``records/NNNN.npz``, under the names that the records of a run have."""
    for number, each in enumerate(walked):
        content = io.BytesIO()
        arrays = {
            "stamp": each.stamps,
            "pose": each.poses,
            "pedestrian_positions": each.positions,
            "pedestrian_states": each.states,
        }
        np.savez_compressed(content, **arrays)  # type: ignore[arg-type]
        write_bytes_whole(record_path(folder, number), content.getvalue())
