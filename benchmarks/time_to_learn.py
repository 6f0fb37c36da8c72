"""How long a Jackal trains until it reaches its goals: by ROSNAV's recipe, and by the default settings of
Stable-Baselines3's PPO.

Same environment (halls like the release's, ten people at 0.3 m/s who ignore the robot), one thread, in turn. Prints CPU
seconds, those of the recipe's lessons among them, until 50, 80 and 90 % of the latest 300 episodes of training, driven
with exploration, reached their goal without a collision. usage: python benchmarks/time_to_learn.py [SECONDS each, at
most, behind the lessons [WAY]]
"""

from __future__ import annotations

import sys
import time
from collections import deque
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback

from arena_core.hosting import load_registry
from arena_gym.building import build_parts, compose_training
from arena_gym.training.imitation import ImitationWorlds, imitate_expert
from arena_gym.training.initial_weights import freeze_policy
from arena_gym.training.learning import make_learner
from arena_gym.training.sb3_vec_env import Sb3VecEnv
from arena_gym.training.session import training_settings
from arena_gym.vector_environment import NavigationVectorEnv

Config = Mapping[str, Any]
Timed = tuple[dict[float, float], float]
MARKS = (0.5, 0.8, 0.9)  # [-] of the latest episodes
LATEST = 300  # [-] episodes
TASK = [
    "world=indoor_large",
    "world.regenerate=1",
    "task.pedestrians=10",
    "randomization.people=null",
    "randomization.crowds={}",
]


class SuccessCallback(BaseCallback):
    """Notes when marks of success are reached, and ends training at the last one or when time is over."""

    def __init__(self, seconds: float, value_steps: int) -> None:
        super().__init__()
        self.reached: dict[float, float] = {}
        self._latest: deque[bool] = deque(maxlen=LATEST)
        self._seconds, self._start = seconds, time.process_time()
        self._value_steps = value_steps

    def _on_training_start(self) -> None:
        self._seconds += time.process_time() - self._start  # lessons are behind

    def _on_rollout_start(self) -> None:
        assert isinstance(self.model, PPO)
        freeze_policy(self.model, held=self.num_timesteps < self._value_steps)

    def _on_step(self) -> bool:
        self._latest.extend(bool(info["is_success"]) for info in self.locals["infos"] if "episode" in info)
        used = time.process_time() - self._start
        share = sum(self._latest) / LATEST
        self.reached.update({mark: used for mark in MARKS if share >= mark and mark not in self.reached})
        return len(self.reached) < len(MARKS) and used < self._seconds


def time_training(
    config: Config, make: Callable[[Sb3VecEnv], PPO], environments: int, seconds: float, value_steps: int = 0
) -> Timed:
    """Train; return CPU seconds to each mark that was reached, and steps a second."""
    env = NavigationVectorEnv(environments, parts=build_parts(config))
    env.batch.parts.pool.fill()
    watch = SuccessCallback(seconds, value_steps)
    learner = make(Sb3VecEnv(env, 0))
    start = time.process_time()
    learner.learn(10**9, watch)
    return watch.reached, learner.num_timesteps / (time.process_time() - start)


def main(seconds: float, chosen: str) -> None:
    """Print a row for each way to train whose name begins so."""
    torch.set_num_threads(1)
    config = compose_training("rosnav", ["robot=jackal", *TASK])
    settings = training_settings(config)

    def by_recipe(worlds: Sb3VecEnv) -> PPO:
        batch = worlds.env.batch
        learner = make_learner(worlds, batch.parts.encoder.layout(), settings, None)
        if settings.teacher.planner is not None:
            with TemporaryDirectory() as folder:
                imitate_expert(
                    learner,
                    ImitationWorlds(batch, settings.teacher.planner, "jackal", load_registry()),
                    settings.teacher,
                    0,
                    Path(folder),
                )
        return learner

    def by_default(worlds: Sb3VecEnv) -> PPO:
        return PPO("MlpPolicy", worlds, seed=0, device="cpu")

    held = settings.start.value_steps if settings.begins_able else 0
    ways = {
        "recipe, 64 worlds": (by_recipe, 64, held),
        "defaults, 64 worlds": (by_default, 64, 0),
        "defaults, 8 worlds": (by_default, 8, 0),
    }
    for name, (make, environments, value_steps) in ways.items():
        if not name.startswith(chosen):
            continue
        reached, rate = time_training(config, make, environments, seconds, value_steps)
        marks = ", ".join(
            f"{mark:.0%}: {reached[mark]:.0f} s" if mark in reached else f"{mark:.0%}: not in {seconds:.0f} s"
            for mark in MARKS
        )
        print(f"{name}: {marks} ({rate:.0f} steps a second)", flush=True)


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 600.0, " ".join(sys.argv[2:]))
