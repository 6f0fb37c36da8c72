"""The drives of a training with forks, kept as files: what is there is not driven again."""

from __future__ import annotations

import io
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, ImpossibleScenario, NoPath, random_generator
from arena_core.commands import interrupts, print_notice
from arena_core.files import read_arrays, write_bytes_whole
from arena_core.hosting import (
    NAVIGATOR_KEYS,
    Benchmark,
    EpisodeLoop,
    build_benchmark,
    compose,
    load_registry,
    mission_of,
    to_plain,
)
from arena_gym.forks.costs import TERMS
from arena_gym.forks.driver import ToldSwitch
from arena_gym.forks.rollouts import Fork, Label
from arena_gym.forks.settings import CostSettings, DriveSettings
from arena_gym.seeds import training_seed

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class States:
    """N states: ``numbers`` (N, D) that a switch sees, ``terms`` (N, K, 3) of each member's cost, the ``member`` that
    drove when they were met, and the ``block`` and ``episode`` of each (N,).
    """

    numbers: NDArray[np.float32]
    terms: Floats
    member: NDArray[np.int64]
    block: NDArray[np.int64]
    episode: NDArray[np.int64]

    def take(self, rows: NDArray[Any]) -> States:
        """Return those of these rows."""
        return States(self.numbers[rows], self.terms[rows], self.member[rows], self.block[rows], self.episode[rows])


@dataclass(frozen=True, slots=True, eq=False)
class Collector:
    """Drives blocks of a training of ``seed`` on the robot and with the members of its composed configuration."""

    config: Mapping[str, Any]
    drives: DriveSettings
    costs: CostSettings
    seed: int

    def collect(self, folder: Path) -> States:
        """Drive what is missing in ``folder`` and return the states of all blocks."""
        folder.mkdir(parents=True, exist_ok=True)
        begun, driven = time.monotonic(), 0
        for block in range(self.drives.blocks):
            path = folder / f"{block:04d}.npz"
            if path.exists():
                continue
            states = self._drive_block(block)
            save_states(path, states)
            driven += 1
            minutes = (time.monotonic() - begun) / driven * (self.drives.blocks - block - 1) / 60.0
            done = f"forks: block {block + 1} of {self.drives.blocks}, {len(states.numbers)} states"
            print(f"{done}, {minutes:.0f} min left", flush=True)
        return load_states([folder / f"{block:04d}.npz" for block in range(self.drives.blocks)])

    def _drive_block(self, block: int) -> States:
        benchmark, switch = self.make_benchmark(block)
        found: list[tuple[int, int, Label]] = []
        for episode in range(self.drives.episodes):
            try:
                found += [(episode, *met) for met in self.drive(benchmark, switch, episode)]
            except (ImpossibleScenario, NoPath) as error:
                print_notice(f"block {block}, drive {episode}: {error}")
        size, count = sum(field.size for field in switch.layout), len(self.config["switch"]["members"])
        return States(
            np.array([label.numbers for *_, label in found], np.float32).reshape(-1, size),
            np.array([label.terms for *_, label in found]).reshape(-1, count, len(TERMS)),
            np.array([member for _, member, _ in found], np.int64),
            np.full(len(found), block),
            np.array([episode for episode, *_ in found], np.int64),
        )

    def make_benchmark(self, block: int) -> tuple[Benchmark, ToldSwitch]:
        """Return what drives a block, with a switch that is told who drives in the planner's place."""
        registry, nodes = load_registry(), self.config["switch"]["members"]
        first = next(iter(nodes.values()))
        config = to_plain(compose([f"planner={first['name']}", *block_words(self.drives, self.seed, block)]))
        config["robot"] = self.config["robot"]
        own = {key: value for key, value in first.items() if key not in NAVIGATOR_KEYS}
        config["planner"] = {**own, **self.drives.navigator}
        benchmark = build_benchmark(config, registry)
        if benchmark.privileged:
            raise ConfigurationError(
                f"{' and '.join(benchmark.privileged)} would see the truth; allowed with forks: what sees sensors alone"
            )
        robot = benchmark.robot
        encoder = registry.build("observation_encoder", self.config["observation_encoder"], robot=robot)
        switch = ToldSwitch.of(nodes, encoder, robot, registry)
        benchmark.navigator.planner = switch
        return benchmark, switch

    def drive(self, benchmark: Benchmark, switch: ToldSwitch, episode: int) -> list[tuple[int, Label]]:
        """Drive one episode, by members that are drawn, and return its states, each with who drove."""
        navigator = benchmark.navigator
        scenario = benchmark.task.scenario(benchmark.settings.seed, episode)
        draw = random_generator(scenario.seed, scenario.name, "switch")
        members = len(self.config["switch"]["members"])
        loop = EpisodeLoop(benchmark.simulator, navigator.control_period, 1, None)
        loop.begin([scenario])
        navigator.reset(mission_of(scenario))
        navigator.rehearse(loop.snapshot.sensors(0))
        held, apart = (round(time / navigator.control_period) for time in (self.drives.held, self.drives.apart))
        fork = Fork(loop, navigator, scenario.world.grid)
        labels: list[tuple[int, Label]] = []
        for step in range(round(self.drives.time_limit / navigator.control_period)):
            interrupts.check()
            if step % held == 0:
                switch.member = int(draw.integers(members))
            if step % apart == apart - 1 and (label := fork.label(members, self.costs)) is not None:
                labels.append((switch.member, label))
            decision = navigator.decide(loop.snapshot.sensors(0))
            if loop.judge(np.array((decision.arrived,))).outcome(0) is not None:
                break
            loop.drive(decision.command.array()[None])
        return labels


def block_words(drives: DriveSettings, seed: int, block: int) -> list[str]:
    """Return the words of `arena run` for the drives of a block, whose seed no test has."""
    draw = random_generator(training_seed(seed, block), "block", "drives")
    shares = np.array(list(drives.worlds.values()))
    world = draw.choice(list(drives.worlds), p=shares / shares.sum())
    density = drives.densities[int(draw.integers(len(drives.densities)))]
    speed = drives.speeds[int(draw.integers(len(drives.speeds)))]
    return [
        f"seed={training_seed(seed, block)}",
        f"world={world}",
        "task=density",
        f"task.density={density:g}",
        f"task.random.people.speed={speed:g}",
        *drives.words,
    ]


def save_states(path: Path, states: States) -> None:
    """Write states, whole or not at all."""
    file = io.BytesIO()
    arrays: dict[str, Any] = {name: getattr(states, name) for name in States.__slots__}
    np.savez_compressed(file, **arrays)
    write_bytes_whole(path, file.getvalue())


def load_states(paths: list[Path]) -> States:
    """Return the states of these files."""
    parts = [read_arrays(path, "states that `arena train` wrote") for path in paths]
    return States(*(np.concatenate([part[name] for part in parts]) for name in States.__slots__))
