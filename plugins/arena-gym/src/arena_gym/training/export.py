"""A trained policy as an ONNX file."""

from __future__ import annotations

import logging
import warnings
from typing import Any

import numpy as np
import torch
from gymnasium.spaces import Discrete
from numpy.typing import NDArray
from stable_baselines3 import PPO
from torch import nn


class Actor(nn.Module):
    """What acts, and all that is exported: the mean of the policy's actions, or what it prefers each member by."""

    def __init__(self, policy: Any) -> None:
        super().__init__()
        self._chooses = isinstance(policy.action_space, Discrete)
        self.features, self.body, self.action = policy.pi_features_extractor, policy.mlp_extractor.policy_net, policy.action_net

    def forward(self, observation: torch.Tensor) -> torch.Tensor:
        """Return the actions (N, A), or what each member is preferred by, for observations (N, D)."""
        actions: torch.Tensor = self.action(self.body(self.features(observation)))
        return actions if self._chooses else actions.clamp(-1.0, 1.0)

    def act(self, observations: NDArray[np.float32]) -> NDArray[np.floating[Any]]:
        """Return the actions (N, A), or the members chosen (N,), for observations (N, D)."""
        device = next(self.parameters()).device
        with torch.no_grad():
            answers: NDArray[np.floating[Any]] = self(torch.as_tensor(observations, device=device)).cpu().numpy()
        return answers.argmax(axis=1) if self._chooses else answers


def to_onnx(learner: PPO, size: int) -> bytes:
    """Return the policy as an ONNX model: ``observation`` (N, ``size``) to ``action`` (N, A), float32, unless of a switch in [-1, 1]."""
    return network_to_onnx(Actor(learner.policy), size, "observation", "action")


def network_to_onnx(network: nn.Module, size: int, input_name: str, output_name: str) -> bytes:
    """Return a network that reads (N, ``size``) numbers as an ONNX model."""
    exporter = logging.getLogger("torch.onnx")
    level = exporter.level
    exporter.setLevel(logging.ERROR)  # it notes every optional package that is not installed
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        program = torch.onnx.export(
            network.to("cpu").eval(),
            (torch.zeros(2, size),),
            dynamo=True,
            input_names=[input_name],
            output_names=[output_name],
            dynamic_shapes=({0: torch.export.Dim("worlds", min=1)},),
            verbose=False,
        )
    exporter.setLevel(level)
    assert program is not None
    return bytes(program.model_proto.SerializeToString())
