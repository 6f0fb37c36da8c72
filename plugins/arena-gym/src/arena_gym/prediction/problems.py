"""The drives that are learned from: worlds, crowds and robots, drawn by seed, apart from every test's."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from arena_gym.prediction.settings import Between, DriveSettings

SEEDS_FROM = 1_000_000  # every seed of a training drive lies from here on; those of tests lie below
SEEDS_APART = 10_000  # between two trainings: more than a training has blocks
DRAWN = ("indoor", "outdoor", "rooms", "cellular", "indoor_large", "outdoor_large")  # worlds that are drawn by seed
GRADED = ("indoor", "outdoor", "rooms", "cellular")  # those of which a difficulty may be asked


def block_words(settings: DriveSettings, seed: int, block: int) -> list[str]:
    """Return the words of ``arena run`` for the drives of a block."""
    draw = np.random.default_rng((seed, block))
    world, people, crowd, localizer = (
        _pick(draw, weights) for weights in (settings.worlds, settings.people, settings.crowds, settings.localizers)
    )
    people_least, people_most = int(settings.pedestrians.low), int(settings.pedestrians.high)
    pace = _uniform(draw, settings.pace) * (1.34 if people == "lifelike" else 0.3)
    words = [
        f"seed={SEEDS_FROM + SEEDS_APART * seed + block}",
        f"world={world}",
        f"people={people}",
        f"pedestrians={crowd}",
        f"localizer={localizer}",
        f"robot={settings.robots[int(draw.integers(len(settings.robots)))]}",
        "planner=pure_pursuit",
        "tracker=kalman",
        "predictor=constant_velocity",
        f"task.pedestrians={int(draw.integers(people_least, people_most + 1))}",
        f"task.placement={draw.choice(('along_route', 'anywhere'))}",
        f"task.time_limit={settings.time_limit}",
        f"task.people.speed={pace:.3f}",
        "pedestrians.reaction=ignore",
        f"pedestrians.factors.social={2.1 * _uniform(draw, settings.social):.3f}",
        f"pedestrians.relaxation_time={_uniform(draw, settings.relaxation):.3f}",
        f"pedestrians.social.gamma={_uniform(draw, settings.reach):.3f}",
    ]
    if world in DRAWN:
        words.append("world.regenerate=1")
    if world in GRADED:
        words.append(f"world.difficulty={_uniform(draw, settings.difficulty):.2f}")
    return words


def _pick(draw: np.random.Generator, weights: Mapping[str, float]) -> str:
    shares = np.array(list(weights.values()), np.float64)
    return str(draw.choice(list(weights), p=shares / shares.sum()))


def _uniform(draw: np.random.Generator, between: Between) -> float:
    return float(draw.uniform(between.low, between.high))
