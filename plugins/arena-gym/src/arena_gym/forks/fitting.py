"""Networks that tell what each member will cost: one for each part of the drives, which it does not see."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from gymnasium.spaces import Box
from numpy.typing import NDArray
from torch import nn

from arena_core import ObservationField
from arena_gym.forks.settings import FitSettings
from arena_gym.training.learning import scan_columns
from arena_gym.training.network import BeamFeatures
from arena_gym.training.settings import Network

Floats = NDArray[np.float64]


class CostNetwork(nn.Module):
    """Answers (N, K) to observations (N, D): what each member costs less than the mean of all, s. The greatest is the
    best.
    """

    def __init__(self, layout: tuple[ObservationField, ...], members: int, settings: Network) -> None:
        super().__init__()
        size = sum(field.size for field in layout)
        self.features: nn.Module = nn.Identity()
        width = size
        if settings.beams_field is not None:
            beams, scans = scan_columns(settings, layout)
            space = Box(-np.inf, np.inf, (size,), np.float32)
            assert settings.features is not None
            features = BeamFeatures(space, beams, scans, settings.convolutions, settings.features)
            self.features, width = features, features.features_dim
        layers: list[nn.Module] = []
        for head in settings.heads:
            layers += [nn.Linear(width, head), nn.ReLU()]
            width = head
        self.body, self.answer = nn.Sequential(*layers), nn.Linear(width, members)
        with torch.no_grad():  # at first all members cost the same
            self.answer.weight.mul_(0.1)
            self.answer.bias.zero_()

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Return the answers."""
        answers: torch.Tensor = self.answer(self.body(self.features(observations)))
        return answers


class MeanNetwork(nn.Module):
    """The mean answer of some networks."""

    def __init__(self, networks: list[CostNetwork]) -> None:
        super().__init__()
        self.networks = nn.ModuleList(networks)

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Return the mean of all answers (N, K)."""
        return torch.stack([network(observations) for network in self.networks]).mean(dim=0)


@dataclass(frozen=True, slots=True, eq=False)
class Lessons:
    """What networks are fitted to: ``numbers`` (N, D) that are seen, ``costs`` (N, K) s, and the ``block`` (N,) of
    each.
    """

    numbers: NDArray[np.float32]
    costs: Floats
    block: NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """The mean of all networks, and what was answered of each state by the one that had not seen it, (N, K)."""

    network: MeanNetwork
    unseen: Floats


def fit_networks(lessons: Lessons, layout: tuple[ObservationField, ...], how: FitSettings, network: Network) -> Fitted:
    """Fit a network for each fold of the blocks; random numbers are those of torch."""
    folds = np.unique(lessons.block, return_inverse=True)[1] % how.folds
    members = lessons.costs.shape[1]
    answers, networks = np.zeros(lessons.costs.shape), []
    for fold in range(how.folds):
        made = CostNetwork(layout, members, network)
        loss = _fit(made, lessons, folds != fold, how)
        hidden = folds == fold
        with torch.no_grad():
            answers[hidden] = made(torch.from_numpy(lessons.numbers[hidden])).numpy()
        print(f"fit: network {fold + 1} of {how.folds}, loss {loss:.3f}", flush=True)
        networks.append(made)
    return Fitted(MeanNetwork(networks), answers)


def _fit(network: CostNetwork, lessons: Lessons, rows: NDArray[np.bool_], how: FitSettings) -> float:
    """Fit a network to these rows, the rate falling along a cosine; return the mean loss of the last epoch."""
    numbers = torch.from_numpy(lessons.numbers[rows])
    gains = torch.from_numpy(gains_of(lessons.costs[rows]).astype(np.float32))
    steps = how.epochs * -(-len(numbers) // how.batch)
    optimizer = torch.optim.AdamW(network.parameters(), how.rate, weight_decay=how.decay)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, steps)
    measure, total = nn.HuberLoss(delta=how.delta), 0.0
    for _ in range(how.epochs):
        total = 0.0
        for chosen in torch.split(torch.randperm(len(numbers)), how.batch):
            loss = measure(network(numbers[chosen]), gains[chosen])
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            schedule.step()
            total += float(loss.detach()) * len(chosen) / len(numbers)
    return total


def gains_of(costs: Floats) -> Floats:
    """Return by how much each member (N, K) costs less than the mean of the same state, s."""
    return np.asarray(costs.mean(axis=1, keepdims=True) - costs)
