"""Which problem each episode of a seed gets, and what differs in it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from arena_core import PedestrianSpec, Scenario, generator, stream_key
from arena_gym.pool import Problem, ProblemPool
from arena_gym.seeds import training_seed
from arena_gym.settings import Randomization, Span


@dataclass(frozen=True, slots=True, eq=False)
class Episode:
    """One episode to train on: its problem as varied; ``noise`` m with the key of its stream, ``latency`` in control steps."""

    problem: Problem
    noise: float
    noise_key: np.uint64
    latency: int


def draw_episode(pool: ProblemPool, randomization: Randomization, seed: int, number: int) -> Episode:
    """Return episode ``number`` of a seed: a pure function of pool, seed and number."""
    name = f"episode/{number}"
    random = generator(training_seed(seed), name, "environment")
    problem = pool.problem(int(random.integers(pool.size)))
    scenario = _varied(problem.scenario, randomization, f"{problem.scenario.name}/{seed}.{number}", random)
    noise = _drawn(randomization.lidar_noise, random)
    latency = int(random.integers(randomization.latency.low, randomization.latency.high + 1))
    return Episode(replace(problem, scenario=scenario), noise, stream_key(training_seed(seed), name, "lidar"), latency)


def _varied(scenario: Scenario, randomization: Randomization, name: str, random: np.random.Generator) -> Scenario:
    """Return the scenario under a name of its own, so that each time it is met its sensors' noise differs."""
    share = _drawn(randomization.speed_share, random)
    people = _varied_people(scenario.pedestrians, randomization, random)
    return replace(scenario, name=name, speed_share=scenario.speed_share * share, pedestrians=people)


def _varied_people(
    people: tuple[PedestrianSpec, ...], randomization: Randomization, random: np.random.Generator
) -> tuple[PedestrianSpec, ...]:
    number = len(people)
    if randomization.people is not None:
        number = min(int(random.integers(randomization.people.low, randomization.people.high + 1)), number)
    factor = _drawn(randomization.people_speed, random)
    if number == len(people) and factor == 1.0:
        return people  # the very same, which simulators may know by now
    chosen = np.sort(random.permutation(len(people))[:number]).tolist()
    return tuple(replace(people[i], desired_speed=people[i].desired_speed * factor) for i in chosen)


def _drawn(span: Span, random: np.random.Generator) -> float:
    return float(random.uniform(span.low, span.high))
