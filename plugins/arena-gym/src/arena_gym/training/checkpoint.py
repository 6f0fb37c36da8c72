"""Checkpoints: all that a training is between two updates, so that one that goes on gives the
weights of one that never stopped.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO

from arena_core import ConfigurationError
from arena_core.commands import one_line
from arena_core.files import write_bytes_whole
from arena_gym.training.learner import Learner
from arena_gym.training.sb3_vec_env import Sb3VecEnv

Weights = dict[str, torch.Tensor]


def weights_of(learner: PPO) -> Weights:
    """Return copies of a learner's weights."""
    return {name: values.detach().cpu().clone() for name, values in learner.policy.state_dict().items()}


def digest_of(weights: Weights) -> str:
    """Return what names these weights, in hexadecimal digits."""
    digest = blake2b(digest_size=16)
    for name in sorted(weights):
        digest.update(name.encode() + weights[name].cpu().numpy().tobytes())
    return digest.hexdigest()


def all_finite(learner: PPO) -> bool:
    """Return whether all weights are numbers."""
    return all(bool(torch.isfinite(values).all()) for values in learner.policy.parameters())


@contextmanager
def checkpoint_errors(path: Path) -> Iterator[None]:
    """Say in one line that a file is none of this training's, whatever a missing, damaged or foreign one raises."""
    try:
        yield
    except Exception as error:
        reason = one_line(str(error) or type(error).__name__)
        raise ConfigurationError(
            f"{path}: is no checkpoint of this training ({reason}); remove the folder to begin again"
        ) from error


def save_checkpoint(
    path: Path, learner: Learner, worlds: Sb3VecEnv, progress: Mapping[str, Any], best: Weights | None
) -> None:
    """Write weights, optimiser, random streams, running episodes, ``progress`` and the best
    weights, whole or not at all.
    """
    content = {
        "policy": learner.policy.state_dict(),
        "optimizer": learner.policy.optimizer.state_dict(),
        "updates": learner.updates,
        "steps": learner.num_timesteps,
        "random": _random_state(),
        "episodes": _with_tensors(worlds.state()),
        "progress": dict(progress),
        "best": best,
    }
    file = io.BytesIO()
    torch.save(content, file)
    write_bytes_whole(path, file.getvalue())


def load_checkpoint(
    path: Path, learner: Learner, worlds: Sb3VecEnv | None = None
) -> tuple[dict[str, Any], Weights | None]:
    """Give a learner and its worlds the state of a checkpoint; return its progress and the best weights.

    Without ``worlds`` only weights and optimiser are taken. Reads tensors and plain numbers, never code. Raises
    ConfigurationError for a file that is no checkpoint of this training.
    """
    with checkpoint_errors(path):
        content = torch.load(path, weights_only=True, map_location=learner.device)
        learner.policy.load_state_dict(content["policy"])
        learner.policy.optimizer.load_state_dict(content["optimizer"])
        learner.restore_counts(int(content["updates"]), int(content["steps"]))
        progress, best = dict(content["progress"]), content["best"]
        episodes, streams = _with_arrays(content["episodes"]), content["random"]
    if worlds is not None:
        learner.restore_observations(*worlds.restore(episodes))
        _restore_random(streams)
    return progress, best


def steps_of(path: Path) -> int:
    """Return after how many steps a checkpoint was written, 0 where there is none; raise
    ConfigurationError for a file that is none.
    """
    if not path.exists():
        return 0
    with checkpoint_errors(path):
        return int(torch.load(path, weights_only=True, map_location="cpu")["steps"])


def _random_state() -> dict[str, Any]:
    """Return the streams that Stable-Baselines3 draws from: torch's for exploration, numpy's
    global one for minibatches.
    """
    _, keys, place, has_gauss, gauss = np.random.get_state(legacy=True)  # noqa: NPY002 - the one that the library uses
    cuda = torch.cuda.get_rng_state_all() if torch.cuda.is_available() else []
    numbers = torch.from_numpy(np.asarray(keys).astype(np.int64))
    return {"torch": torch.get_rng_state(), "cuda": cuda, "numpy": [numbers, int(place), int(has_gauss), float(gauss)]}


def _restore_random(state: Mapping[str, Any]) -> None:
    keys, place, has_gauss, gauss = state["numpy"]
    words = keys.cpu().numpy().astype(np.uint32)
    np.random.set_state(("MT19937", words, place, has_gauss, gauss))  # noqa: NPY002 - likewise
    torch.set_rng_state(state["torch"].cpu())
    if state["cuda"] and torch.cuda.is_available():
        torch.cuda.set_rng_state_all([one.cpu() for one in state["cuda"]])


def _with_tensors(state: Mapping[str, Any]) -> dict[str, Any]:
    return {key: torch.from_numpy(value) if isinstance(value, np.ndarray) else value for key, value in state.items()}


def _with_arrays(state: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value.cpu().numpy() if isinstance(value, torch.Tensor) else value for key, value in state.items()}
