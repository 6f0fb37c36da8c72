"""Gymnasium environments of the arena suite."""

from importlib import import_module
from typing import Any

from arena_core import Register, hookimpl


def __getattr__(name: str) -> Any:
    """Return ``train`` or ``team_env`` when first asked for: every ``arena`` command imports this module, few train."""
    if name in ("train", "team_env"):
        return getattr(import_module("arena_gym.api"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


@hookimpl
def register_rewards(register: Register) -> None:
    """Offer the rewards."""
    register("release", "arena_gym.release_reward:ReleaseReward")
    register("progress", "arena_gym.progress_reward:ProgressReward")
    register("normalized_progress", "arena_gym.normalized_progress_reward:NormalizedProgressReward")
    register("switch", "arena_gym.switch_reward:SwitchReward")


@hookimpl
def register_trainers(register: Register) -> None:
    """Offer what `arena predict train` trains by, and how a switch learns from forks."""
    register("prediction", "arena_gym.prediction.trainer:PredictionTrainer")
    register("switch_forks", "arena_gym.forks.trainer:ForkTrainer")


@hookimpl
def register_commands(register: Register) -> None:
    """Offer ``arena train`` and ``arena trainings``."""
    register("train", "arena_gym.train_command:TrainCommand")
    register("trainings", "arena_gym.trainings_command:TrainingsCommand")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_gym.conf"
