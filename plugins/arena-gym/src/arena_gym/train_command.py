"""``arena train``: from a recipe to a policy with its card."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import ClassVar

from arena_core import Command, ConfigurationError
from arena_gym.building import compose_environment

USAGE = "usage: arena train planner=NAME robot=NAME [seed=0] [total_steps=N] [device=cpu] [out=DIR] [resume=true] [KEY=VALUE ...]"
NEEDED = ("torch", "stable_baselines3", "onnx", "onnxscript", "tensorboard", "rich")


class TrainCommand(Command):
    """Train a learned planner for a robot."""

    help: ClassVar[str] = "train a learned planner: arena train planner=rosnav robot=jackal"

    def run(self, arguments: Sequence[str]) -> int:
        """Train, and write policy, card, curve and logs to a folder."""
        if any(word in ("-h", "--help") for word in arguments):
            print(USAGE)
            return 0
        _check_installed()
        words = [word for word in arguments if not word.startswith(("out=", "resume=", "planner="))]
        given = dict(word.split("=", 1) for word in arguments if word.startswith(("out=", "resume=", "planner=")))
        recipe = [f"recipe={given['planner']}"] if "planner" in given else []
        config = compose_environment([*recipe, *words], primary="train")
        folder = Path(given.get("out") or f"trainings/{config['planner']}_{config['robot']['name']}_{config['seed']}")
        resume = given.get("resume", "false")
        if resume not in ("true", "false"):
            raise ConfigurationError(f"resume is {resume}; allowed: true, false")
        from arena_gym.training.session import run_training

        return run_training(config, folder, resume == "true")


def _check_installed() -> None:
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing:
        raise ConfigurationError(f"arena train needs {', '.join(missing)}; install the extra arena-gym[train]")
