"""``arena train``: from a recipe to a policy with its card."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import ClassVar

from arena_core import Command, ConfigurationError, complete_overrides, load_registry, option_files, read_words
from arena_gym.building import compose_environment

USAGE = "arena train planner=NAME robot=NAME [seed=0] [total_steps=N] [device=cpu] [out=DIR] [resume=true] [KEY=VALUE ...]"
OWN = ("planner", "out", "resume")
NEEDED = ("torch", "stable_baselines3", "onnx", "onnxscript", "tensorboard", "rich")


class TrainCommand(Command):
    """Train a learned planner for a robot."""

    help: ClassVar[str] = "train a learned planner: arena train planner=rosnav robot=jackal"

    def run(self, arguments: Sequence[str]) -> int:
        """Train, and write policy, card, curve and logs to a folder."""
        if any(word in ("-h", "--help") for word in arguments):
            print(f"usage: {USAGE}")
            return 0
        _check_installed()
        words = read_words(USAGE, arguments, keys=OWN, overrides=None)
        recipe = [f"recipe={words.keys['planner']}"] if "planner" in words.keys else []
        resume = words.value("resume", bool, False)
        config = compose_environment([*recipe, *words.overrides], primary="train")
        folder = Path(words.keys.get("out", f"trainings/{config['planner']}_{config['robot']['name']}_{config['seed']}"))
        if config["trainer"] is not None:
            load_registry().build("trainer", config["trainer"]).train(config, folder, resume)
            return 0
        from arena_gym.training.session import run_training

        return run_training(config, folder, resume)

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the planners that have a recipe, and overrides."""
        if word.startswith("planner="):
            return [f"planner={recipe}" for recipe in option_files("recipe", load_registry().manager)]
        return [*(f"{key}=" for key in OWN), "resume=true", *complete_overrides(words, word, primary="train")]


def _check_installed() -> None:
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing:
        raise ConfigurationError(f"arena train needs {', '.join(missing)}; install the extra arena-gym[train]")
