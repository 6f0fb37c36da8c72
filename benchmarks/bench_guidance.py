"""Simulated robot-seconds a CPU-second of a training with everything (resets, network, update): guided by a model of
the real parts (guide=batched), by the real parts (guide=driving), and without guidance; in turn, in one process.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from statistics import median
from tempfile import mkdtemp
from typing import Any

from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import Logger
from timing import interleave

from arena_gym.building import build_parts, compose_training
from arena_gym.training.session import training_settings
from arena_gym.training.trainer import prepare_learner
from arena_gym.vector_environment import NavigationVectorEnv

WORLDS, STEPS, REPEATS = 64, 32, 5
ROBOTS = ("turtlebot3", "jackal")
TRACKED = "tracker@guide.tracker=kalman"
GUIDES = {
    "batched": ("guide=batched", TRACKED),
    "driving": (),
    "none": ("observation_encoder.foreseen=[]",),
}
LESS = (
    "environment.worlds=16",
    "environment.problems_per_world=2",
    f"training.optimization.environments={WORLDS}",
    f"training.optimization.steps={STEPS}",
    "training.optimization.minibatch=512",
)
GOAL = 0.25  # of the time with the real parts


class _Nothing(BaseCallback):
    def _on_step(self) -> bool:
        return True


def training_of(robot: str, guide: str) -> tuple[Callable[[], None], float]:
    """Return a roll-out with its update of ROSNAV's recipe, and how many robot-seconds it simulates."""
    config = compose_training("rosnav", [f"robot={robot}", *LESS, *GUIDES[guide]])
    parts = build_parts(config if guide != "none" else {**config, "guide": None})
    parts.pool.fill()
    env = NavigationVectorEnv(WORLDS, parts=parts)
    learner, _ = prepare_learner(training_settings(config), env, Path(mkdtemp()))
    learner.set_logger(Logger(None, []))
    seconds = WORLDS * STEPS * parts.settings.every * parts.robot.control_period

    def run() -> None:
        learner.learn(WORLDS * STEPS, _Nothing(), reset_num_timesteps=learner.num_timesteps == 0)

    return run, seconds


def measure(robots: tuple[str, ...] = ROBOTS) -> list[dict[str, Any]]:
    """Return for each robot the time of a simulated second with a model and without guidance, beside the real parts."""
    rows: list[dict[str, Any]] = []
    for robot in robots:
        runs = {guide: training_of(robot, guide) for guide in GUIDES}
        times = interleave({guide: run for guide, (run, _) in runs.items()}, REPEATS)
        ms = {guide: 1e3 * median(times[guide]) / seconds for guide, (_, seconds) in runs.items()}
        rows += [
            {
                "what": f"a simulated robot-second in training, {WORLDS} worlds, {robot}, guide={guide}",
                "ours_ms": ms[guide],
                "peer": "guide=driving",
                "peer_ms": ms["driving"],
                "ratio": ms[guide] / ms["driving"],
                "goal": GOAL,
                "unit": "x peer",
            }
            for guide in ("batched", "none")
        ]
    return rows


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", action="append", help="may be given again")
    for row in measure(tuple(parser.parse_args().robot or ROBOTS)):
        print(
            f"{row['what']}: {1e3 / row['ours_ms']:.0f} robot-seconds a CPU-second, "
            f"{row['peer']} {1e3 / row['peer_ms']:.0f}; {1 / row['ratio']:.2f} times as many"
        )
