"""How long a Jackal trains until it reaches its goals: by ROSNAV's recipe, and by the default settings of Stable-Baselines3's PPO.

Same environment (halls like the release's, ten people at 0.3 m/s who ignore the robot), one thread, in turn. Prints CPU seconds until 50,
80 and 90 % of the latest 300 episodes of training, driven with exploration, reached their goal without a collision.
usage: python benchmarks/time_to_learn.py [SECONDS each, at most]
"""

from __future__ import annotations

import sys
import time
from collections import deque
from collections.abc import Callable

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback

from arena_gym.building import build_parts, compose_training
from arena_gym.training.learning import make_learner
from arena_gym.training.session import training_settings
from arena_gym.training.worlds_in_step import WorldsInStep
from arena_gym.vector_environment import NavigationVectorEnv

MARKS = (0.5, 0.8, 0.9)  # [-] of the latest episodes
LATEST = 300  # [-] episodes
TASK = [
    "world=indoor_as_released",
    "world.regenerate=1",
    "task.pedestrians=10",
    "randomization.people=null",
    "randomization.crowds={}",
]


class Watch(BaseCallback):
    """Notes when marks of success are reached, and ends training at the last one or when time is over."""

    def __init__(self, seconds: float) -> None:
        super().__init__()
        self.reached: dict[float, float] = {}
        self._latest: deque[bool] = deque(maxlen=LATEST)
        self._seconds, self._start = seconds, time.process_time()

    def _on_step(self) -> bool:
        self._latest.extend(bool(info["is_success"]) for info in self.locals["infos"] if "episode" in info)
        used = time.process_time() - self._start
        share = sum(self._latest) / LATEST
        self.reached.update({mark: used for mark in MARKS if share >= mark and mark not in self.reached})
        return len(self.reached) < len(MARKS) and used < self._seconds


def timed(make: Callable[[WorldsInStep], PPO], environments: int, seconds: float) -> tuple[dict[float, float], float]:
    """Train; return CPU seconds to each mark that was reached, and steps a second."""
    config = compose_training("rosnav", ["robot=jackal", *TASK])
    env = NavigationVectorEnv(environments, parts=build_parts(config))
    env.batch.parts.pool.fill()
    learner, watch = make(WorldsInStep(env, 0)), Watch(seconds)
    start = time.process_time()
    learner.learn(10**9, watch)
    return watch.reached, learner.num_timesteps / (time.process_time() - start)


def main(seconds: float) -> None:
    """Print a row for each way to train."""
    torch.set_num_threads(1)
    config = compose_training("rosnav", ["robot=jackal", *TASK])
    settings = training_settings(config)
    ways: dict[str, tuple[Callable[[WorldsInStep], PPO], int]] = {
        "recipe, 64 worlds": (lambda w: make_learner(w, w.env.batch.parts.encoder.layout(), settings, None), 64),
        "defaults, 64 worlds": (lambda w: PPO("MlpPolicy", w, seed=0, device="cpu"), 64),
        "defaults, 8 worlds": (lambda w: PPO("MlpPolicy", w, seed=0, device="cpu"), 8),
    }
    for name, (make, environments) in ways.items():
        reached, rate = timed(make, environments, seconds)
        marks = ", ".join(
            f"{mark:.0%}: {reached[mark]:.0f} s" if mark in reached else f"{mark:.0%}: not in {seconds:.0f} s" for mark in MARKS
        )
        print(f"{name}: {marks} ({rate:.0f} steps a second)", flush=True)


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 600.0)
