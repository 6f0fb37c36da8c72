"""Weights to begin a training with: those of a policy that was trained before."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import onnx
import torch
from numpy.typing import NDArray
from onnx import numpy_helper
from stable_baselines3 import PPO

from arena_core import InputFileError, ObservationField
from arena_core.commands import one_line
from arena_core.files import local_path
from arena_gym.training.export import Actor
from arena_policies.card import read_card
from arena_policies.network import network_content
from arena_policies.policy import check_layout


def load_weights(learner: PPO, address: str, layout: tuple[ObservationField, ...]) -> None:
    """Give a learner's policy the weights of a file (a path or pkg://); its value stays as it was drawn.

    Raises InputFileError or ConfigurationError for a file that is no policy, one that reads another observation, and
    one whose network has another structure.
    """
    path = local_path(address)
    content = network_content(path)
    card = read_card(path.with_suffix(".json"))
    check_layout(path.with_suffix(".json"), card.robot, card.layout, layout)
    try:
        found = {one.name: numpy_helper.to_array(one) for one in onnx.load_from_string(content).graph.initializer}
    except Exception as error:  # protobuf's own kinds, for a damaged or foreign file
        raise InputFileError(
            f"{path}: is no ONNX model ({one_line(str(error))}); allowed: one that `arena train` wrote"
        ) from None
    with torch.no_grad():
        for name, weights in Actor(learner.policy).named_parameters():
            weights.copy_(torch.from_numpy(_reshape_weights(path, name, found.get(name), tuple(weights.shape))))


def _reshape_weights(path: Path, name: str, found: NDArray[Any] | None, shape: tuple[int, ...]) -> NDArray[Any]:
    """Return a file's weights in a network's shape; axes of one do not count (a convolution in
    one dimension or in two).
    """
    if found is None or [size for size in found.shape if size != 1] != [size for size in shape if size != 1]:
        there = "missing" if found is None else found.shape
        raise InputFileError(f"{path}: {name} is {there}; allowed: {shape}, as training.network says")
    return found.reshape(shape).copy()


def freeze_policy(learner: PPO, *, held: bool) -> None:
    """Let updates leave the policy, what it sees by and the spread of its actions as
    they are, or let them learn again.
    """
    for weights in (
        *Actor(learner.policy).parameters(),
        *([learner.policy.log_std] if hasattr(learner.policy, "log_std") else []),
    ):
        weights.requires_grad_(not held)
