"""Which problem each episode of a seed gets, and what differs in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arena_core import PedestrianSpec, Scenario, random_generator, stream_key
from arena_gym.pool import Problem, ProblemPool
from arena_gym.seeds import training_seed
from arena_gym.settings import CrowdKind, Randomization, Span


@dataclass(frozen=True, slots=True)
class EpisodeKey:
    """What an episode is drawn from: its seed, its number under it, and its level where the task has any."""

    seed: int
    number: int
    stage: int | None


@dataclass(frozen=True, slots=True, eq=False)
class Episode:
    """One episode to train on: its problem as varied; ``noise`` m with the key of its stream,
    ``latency`` in control steps. ``mates`` are the same episode as the other robots of a team face it.
    """

    problem: Problem
    noise: float
    noise_key: np.uint64
    latency: int
    mates: tuple[Episode, ...] = ()


def draw_episode(pool: ProblemPool, randomization: Randomization, seed: int, number: int) -> Episode:
    """Return episode ``number`` of a seed: a pure function of pool, seed and number."""
    name = f"episode/{number}"
    random = random_generator(training_seed(seed), name, "environment")
    problem = pool.problem(int(random.integers(pool.size)))
    scenario = _vary_scenario(problem.scenario, randomization, f"{problem.scenario.name}/{seed}.{number}", random)
    noise = _draw_uniform(randomization.lidar_noise, random)
    latency = int(random.integers(randomization.latency.low, randomization.latency.high + 1))
    mates = (
        Episode(
            replace(mate, scenario=scenario.seen_by(member)),
            noise,
            stream_key(training_seed(seed), f"{name}/robot{member}", "lidar"),
            latency,
        )
        for member, mate in enumerate(problem.mates, 1)
    )
    key = stream_key(training_seed(seed), name, "lidar")
    return Episode(replace(problem, scenario=scenario), noise, key, latency, tuple(mates))


def draw_stage(weights: Sequence[float], seed: int, number: int) -> int:
    """Return the level of episode ``number`` of a seed, drawn with these ``weights`` of levels: a pure function."""
    bounds = np.cumsum(weights)
    at = random_generator(training_seed(seed), f"episode/{number}", "level").uniform(0.0, bounds[-1])
    return min(int(np.searchsorted(bounds, at, side="right")), len(bounds) - 1)


def _vary_scenario(
    scenario: Scenario, randomization: Randomization, name: str, random: np.random.Generator
) -> Scenario:
    """Return the scenario under a name of its own, so that each time it is met its sensors' noise differs."""
    share = _draw_uniform(randomization.speed_share, random)
    people = _vary_people(scenario.pedestrians, randomization, random)
    return replace(scenario, name=name, speed_share=scenario.speed_share * share, pedestrians=people)


def _vary_people(
    people: tuple[PedestrianSpec, ...], randomization: Randomization, random: np.random.Generator
) -> tuple[PedestrianSpec, ...]:
    number = len(people)
    if randomization.people is not None:
        number = min(int(random.integers(randomization.people.low, randomization.people.high + 1)), number)
    factor = _draw_uniform(randomization.people_speed, random)
    kind = _draw_crowd_kind(randomization, random)
    if kind is not None:
        factor *= _draw_uniform(kind.speed, random)
    reaction = kind.reaction if kind is not None else None
    if number == len(people) and factor == 1.0 and reaction is None:
        return people  # the very same, which simulators may know by now
    chosen = np.sort(random.permutation(len(people))[:number]).tolist()
    return tuple(_apply_kind(people[i], factor, reaction) for i in chosen)


def _draw_crowd_kind(randomization: Randomization, random: np.random.Generator) -> CrowdKind | None:
    """Draw the kind of people of an episode; None where there are no kinds."""
    if not randomization.crowds:
        return None
    kinds = list(randomization.crowds.values())
    shares = np.cumsum([kind.share for kind in kinds])
    return kinds[int(np.searchsorted(shares, random.uniform(0.0, shares[-1]), side="right"))]


def _apply_kind(person: PedestrianSpec, factor: float, reaction: str | None) -> PedestrianSpec:
    behaviour = person.behaviour if reaction is None else {**person.behaviour, "reaction": reaction}
    return replace(person, desired_speed=person.desired_speed * factor, behaviour=behaviour)


def _draw_uniform(span: Span, random: np.random.Generator) -> float:
    return float(random.uniform(span.low, span.high))
