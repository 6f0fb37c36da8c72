"""The policy's network: convolutions over the beams, after the released agents."""

from __future__ import annotations

from typing import Any

import torch
from gymnasium import spaces
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor, MlpExtractor
from torch import nn

from arena_core import ConfigurationError
from arena_gym.training.settings import Convolution


class BeamFeatures(BaseFeaturesExtractor):
    """1-D convolutions over ``beams``, a slice of the observation, reduced to ``features``; the rest of the observation
    beside them.

    The slice holds ``scans`` scans, one after the other, which are the convolutions' first channels. They are computed
    as images of one row with channels last, which takes three quarters of the time of ``Conv1d`` on a CPU.

    The structure of the released ROSNAV agents (Kaestner et al. 2022, AGENT_24), whose robot state joins behind the
    convolutions.
    """

    def __init__(
        self,
        observation_space: spaces.Box,
        beams: slice,
        scans: int,
        convolutions: tuple[Convolution, ...],
        features: int,
    ) -> None:
        total = int(observation_space.shape[0])
        count = beams.stop - beams.start
        super().__init__(observation_space, features + total - count)
        self._beams, self._scans = beams, scans
        layers: list[nn.Module] = []
        channels, length = scans, count // scans
        for layer in convolutions:
            length = (length - layer.kernel) // layer.stride + 1
            if length < 1:
                raise ConfigurationError(
                    f"training.network.convolutions leave nothing of {count // scans} beams; allowed: "
                    "fewer or smaller ones"
                )
            layers += [nn.Conv2d(channels, layer.channels, (1, layer.kernel), (1, layer.stride)), nn.ReLU()]
            channels = layer.channels
        self.convolutions = nn.Sequential(*layers, nn.Flatten())
        self.reduced = nn.Sequential(nn.Linear(channels * length, features), nn.ReLU())

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Return the features (N, F) of observations (N, D)."""
        start, stop = self._beams.start, self._beams.stop
        scans = observations[:, start:stop].reshape(-1, self._scans, 1, (stop - start) // self._scans)
        seen = self.reduced(self.convolutions(scans.contiguous(memory_format=torch.channels_last)))
        return torch.cat((seen, observations[:, :start], observations[:, stop:]), dim=1)


class AsymmetricActorCritic(ActorCriticPolicy):
    """A policy and a value of which only the value reads the last ``truth`` columns of what it is shown."""

    def __init__(self, *args: Any, truth: int, **kwargs: Any) -> None:
        self._truth = truth
        super().__init__(*args, **kwargs)

    def _build_mlp_extractor(self) -> None:
        heads = {"net_arch": self.net_arch, "activation_fn": self.activation_fn, "device": self.device}
        self.mlp_extractor = _Heads(self.features_dim, self._truth, **heads)


class _Heads(MlpExtractor):
    """Heads of which that of the policy is narrower by the truth, which stands last in the features."""

    def __init__(self, features: int, truth: int, **heads: Any) -> None:
        super().__init__(features, **heads)
        self._seen = features - truth
        self.policy_net = MlpExtractor(self._seen, **heads).policy_net

    def forward_actor(self, features: torch.Tensor) -> torch.Tensor:
        """Return what the actions are made of, from what the robot sees."""
        answer: torch.Tensor = self.policy_net(features[:, : self._seen])
        return answer
