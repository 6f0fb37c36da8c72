"""Teams and trainings from Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from arena_core import ConfigurationError
from arena_core.hosting import load_registry, require_extra

if TYPE_CHECKING:
    from arena_gym.team_environment import TeamEnv

NEEDED = ("torch", "stable_baselines3", "onnx", "onnxscript", "tensorboard", "rich")


def team_env(robots: int | None = 4, *, overrides: Sequence[str] = (), **choices: str) -> TeamEnv:
    """Return a team in one world as a parallel environment of PettingZoo, the one of ``task=antipodal`` in
    ``world=empty`` unless ``choices`` say otherwise: robot, world, task, reward, observation.

    ``robots`` is their number (None: as the task says); ``overrides`` are those of ``arena run``. Raises ArenaError in
    one line for whatever is wrong.
    """
    require_extra("arena_gym.team_env", ["pettingzoo"], "arena-gym[team]")
    from arena_gym.team_environment import TeamEnv

    return TeamEnv(robots, overrides, choices)


def train(env: Any, recipe: str, folder: str | Path | None = None, *, resume: bool = False) -> Path:
    """Train by a recipe, as ``arena train``, and return the file of the policy, which lies in ``folder``
    (``trainings/PLANNER_ROBOT_SEED``).

    ``env`` is an environment of ``gymnasium.make`` or ``make_vec``, whose components and settings take the place of
    the recipe's, or the words of the command line, such as ``["robot=jackal", "total_steps=200000"]``. Raises
    ArenaError in one line for whatever is wrong.
    """
    require_extra("arena_gym.train", NEEDED, "arena-gym[train]")
    from arena_gym.building import compose_training

    if isinstance(env, Sequence):
        config = compose_training(recipe, list(env))
    else:
        own = env.unwrapped.batch.parts.config
        config = {**compose_training(recipe, [f"robot={own['robot']['name']}"]), **own}
    out = Path(folder or f"trainings/{config['planner']}_{config['robot']['name']}_{config['seed']}")
    train_config(config, out, None, resume=resume)
    return out / "policy.onnx"


def train_config(
    config: Mapping[str, Any], folder: Path, robot: str | None, *, resume: bool, force: bool = False
) -> None:
    """Train by a composed configuration to ``folder``, in the way of its recipe; ``robot`` is the name of its file,
    its own where None.
    """
    if config["trainer"] is not None:
        _check_unused(config)
        _run_trainer(config, folder, resume=resume)
        return
    from arena_gym.training.session import run_training

    run_training(config, folder, robot, resume=resume, force=force)


def _run_trainer(config: Mapping[str, Any], folder: Path, *, resume: bool) -> None:
    try:
        load_registry().build("trainer", config["trainer"]).train(config, folder, resume=resume)
    except KeyboardInterrupt as interrupt:
        kept = [path for path in (folder / "checkpoint.pt", folder / "states") if path.exists()]
        said = (
            f"{kept[0]} is kept, resume=true (with the same words) goes on from there"
            if kept
            else "nothing was kept as yet"
        )
        interrupt.add_note(said)
        raise


def _check_unused(config: Mapping[str, Any]) -> None:
    """Refuse what a way of training of its own does not read."""
    own = {"teacher.planner": config["teacher"]["planner"], "later.reward": config["later"]["reward"]}
    own |= {key: config[key] for key in ("horizon", "exploration_time", "wandb")}
    for key, value in own.items():
        if value is not None:
            raise ConfigurationError(
                f"{key} is {value}; allowed: null for {config['planner']}, which trains in a way of its own"
            )
