"""What an observation has to show: how nearly a network can do what TEB does, by parts of ROSNAV's observation, and how
well it drives.

TEB and a policy that imitates it drive a robot among people, in lessons as a training begins with. Networks of ROSNAV's
structure then learn what TEB would have done from what they are shown, as in lessons. A last lesson in other worlds
says how far off they are (mean of absolute values, in halves of the actions' ranges), the test of a training how often
they arrive without a collision; means over three seeds. Nothing is learned from rewards: a row takes minutes, not
hours. usage: python benchmarks/what_to_show.py [ROBOT [LESSONS [EPISODES]]]   (0 episodes: nothing of how often they
arrive)
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from arena_core import ObservationField, random_generator
from arena_core.hosting import load_registry
from arena_gym.building import build_parts, compose_training
from arena_gym.training.evaluation import evaluate_policy, unseen_worlds
from arena_gym.training.export import Actor
from arena_gym.training.imitation import ImitationWorlds, fit_imitation
from arena_gym.training.session import training_settings
from arena_gym.training.settings import ExpertSettings, Network, TrainingSettings
from arena_gym.training.trainer import prepare_learner
from arena_gym.vector_environment import NavigationVectorEnv

SEEDS = (0, 1, 2)  # of first weights and minibatches
EPOCHS = 12
WIDE = 2.0  # times as many features and neurons
LOOKBACK, FORESEEN = (0.5, 1.0), (0.75, 1.5, 2.5, 4.0)  # [s]
Rows = NDArray[np.float32]


class Imitator(nn.Module):
    """ROSNAV's structure over some ``scans`` (each of so many sectors) and some other
    ``columns`` of the observation.
    """

    def __init__(
        self, network: Network, sectors: int, scans: Sequence[int], columns: Sequence[int], actions: int
    ) -> None:
        super().__init__()
        self._sectors, self._scans, self._columns = sectors, list(scans), list(columns)
        layers: list[nn.Module] = []
        channels = len(scans)
        for layer in network.convolutions:
            layers += [nn.Conv1d(channels, layer.channels, layer.kernel, layer.stride), nn.ReLU()]
            channels = layer.channels
        self._convolutions = nn.Sequential(*layers, nn.Flatten())
        width = self._convolutions(torch.zeros(1, len(scans), sectors)).shape[1]
        assert network.features is not None
        self._features = nn.Sequential(nn.Linear(width, network.features), nn.ReLU())
        sizes = [network.features + len(columns), *network.heads]
        heads = [part for a, b in pairwise(sizes) for part in (nn.Linear(a, b), nn.ReLU())]
        self._heads = nn.Sequential(*heads, nn.Linear(sizes[-1], actions))

    def action_means(self, seen: torch.Tensor) -> torch.Tensor:
        """Return actions (N, A) for whole observations (N, D)."""
        beams = torch.stack([seen[:, k * self._sectors : (k + 1) * self._sectors] for k in self._scans], 1)
        answer: torch.Tensor = self._heads(
            torch.cat((self._features(self._convolutions(beams)), seen[:, self._columns]), 1)
        )
        return answer


@dataclass(frozen=True, slots=True, eq=False)
class ExpertRollouts:
    """Lessons: their training's ``config`` and ``settings``, what was ``seen`` and shown in each, and ``apart``, in
    other worlds.

    ``layout`` is the observation's, ``actions`` are their names.
    """

    config: dict[str, Any]
    settings: TrainingSettings
    seen: list[tuple[Rows, Rows]]
    apart: tuple[Rows, Rows]
    layout: tuple[ObservationField, ...]
    actions: tuple[str, ...]


def collect_rollouts(robot: str, count: int) -> ExpertRollouts:
    """Hold so many lessons, and one more in other worlds."""
    times = [f"observation_encoder.lookback={list(LOOKBACK)}", f"observation_encoder.foreseen={list(FORESEEN)}"]
    path = ["observation_encoder.ahead=4", "observation_encoder.spacing=0.5"]
    config = compose_training("rosnav", [f"robot={robot}", *times, *path, f"teacher.rounds={count}"])
    settings, registry = training_settings(config), load_registry()
    parts = build_parts(config, registry)
    others = build_parts({**config, "environment": {**config["environment"], "seed": 1}}, registry)
    env = NavigationVectorEnv(settings.optimization.environments, parts=parts)
    classroom = ImitationWorlds(env.batch, "teb", robot, registry)
    held: list[tuple[Rows, Rows]] = []
    with TemporaryDirectory() as folder:
        actor = Actor(prepare_learner(settings, env, Path(folder))[0].policy)
        optimizer = torch.optim.Adam(actor.parameters(), lr=settings.teacher.learning_rate)
        for k in range(count):
            lesson = classroom.collect_rollout(
                actor, settings.teacher.decisions, 1.0 - k / max(count - 1, 1), k * env.num_envs
            )
            held.append((lesson.seen, lesson.shown))
            fit_imitation(
                actor, optimizer, held, settings.teacher, 1.0 - k / count, random_generator(k, "lesson", "minibatches")
            )
            print(f"lesson {k + 1} of {count}: {dict(lesson.ends)}", file=sys.stderr, flush=True)
        elsewhere = ImitationWorlds(NavigationVectorEnv(env.num_envs, parts=others).batch, "teb", robot, registry)
        lesson = elsewhere.collect_rollout(actor, settings.teacher.decisions, 0.5, 0)
    return ExpertRollouts(
        config, settings, held, (lesson.seen, lesson.shown), parts.encoder.layout(), parts.scale.names
    )


def fit_network(net: Imitator, held: list[tuple[Rows, Rows]], settings: ExpertSettings, seed: int) -> None:
    """Let a network imitate, more slowly from epoch to epoch."""
    optimizer = torch.optim.Adam(net.parameters(), lr=settings.learning_rate)
    random = random_generator(seed, "what to show", "minibatches")
    for epoch in range(EPOCHS):
        fit_imitation(net, optimizer, held, replace(settings, epochs=1), 1.0 - epoch / EPOCHS, random)


def success_share(net: Imitator, held: ExpertRollouts, episodes: int) -> float:
    """Return the share of a training's test that a network arrives in without a collision."""

    def act(observations: Rows) -> Rows:
        with torch.no_grad():
            return net.action_means(torch.from_numpy(observations)).clamp(-1.0, 1.0).numpy()

    chosen = held.settings.test
    return evaluate_policy(
        unseen_worlds(held.config, episodes, chosen.seed, "training.test.seed"), act, episodes, chosen.seed
    ).success


def observation_parts(layout: Sequence[ObservationField]) -> Iterator[tuple[str, list[int], list[int], float]]:
    """Yield what is shown: its name, the scans, the other columns, and how many times as wide the network is."""
    scans = sum(field.name.startswith("closeness") for field in layout)
    ends = np.cumsum([field.size for field in layout])
    path = list(range(int(ends[-2]), int(ends[-1])))  # the points ahead stand last
    state = list(range(int(ends[scans - 1]), int(ends[-2])))
    past, foreseen = [1, 2], list(range(1 + len(LOOKBACK), scans))
    yield "the scan", [0], state, 1.0
    yield "and half a second and a second ago", [0, *past], state, 1.0
    yield "and the first and third foreseen", [0, foreseen[0], foreseen[2]], state, 1.0
    yield "and all four foreseen", [0, *foreseen], state, 1.0
    yield "and four points of the path", [0], state + path, 1.0
    yield "foreseen, and the path", [0, *foreseen], state + path, 1.0
    yield "the same, by a network twice as wide", [0, *foreseen], state + path, WIDE
    yield "all of it", [0, *past, *foreseen], state + path, 1.0


def main(robot: str, count: int, episodes: int) -> None:
    """Print a row for each way."""
    torch.set_num_threads(1)
    held = collect_rollouts(robot, count)
    seen_apart, shown_apart = (torch.from_numpy(rows) for rows in held.apart)
    spread = (shown_apart - shown_apart.median(0).values).abs().mean(0)
    columns = [*held.actions, *["arrives"] * (episodes > 0)]
    print(f"| {robot} is shown | {' | '.join(columns)} |\n| --- |{' --- |' * len(columns)}")
    print(
        f"| nothing (what TEB's actions spread by) | {' | '.join(f'{value:.3f}' for value in spread)} "
        f"|{' |' * (episodes > 0)}",
        flush=True,
    )
    network = held.settings.network
    assert network.features is not None
    for name, scans, columns, times in observation_parts(held.layout):
        wide = replace(
            network, features=int(times * network.features), heads=tuple(int(times * size) for size in network.heads)
        )
        off = []
        for seed in SEEDS:
            torch.manual_seed(seed)
            net = Imitator(wide, held.layout[0].size, scans, columns, len(held.actions))
            fit_network(net, held.seen, held.settings.teacher, seed)
            with torch.no_grad():
                apart = (net.action_means(seen_apart) - shown_apart).abs().mean(0).tolist()
            off.append([*apart, success_share(net, held, episodes)] if episodes else apart)
        told = [f"{np.mean(one):.3f} ({min(one):.3f} .. {max(one):.3f})" for one in zip(*off, strict=True)]
        print(f"| {name} | {' | '.join(told)} |", flush=True)


if __name__ == "__main__":
    robot, count, episodes = (*sys.argv[1:], *("jackal", "8", "300")[len(sys.argv) - 1 :])
    main(robot, int(count), int(episodes))
