"""Value networks, and what they are as ONNX files: rows (N, D) of a joint state to values (N, 1)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import torch
from torch import nn

from arena_cadrl.parameters import OWN, PERSON
from arena_cadrl.training.settings import ValueSettings

FIRST_VALUE = 0.5  # of a network that has learned nothing: half of what free driving is worth


def make_network(settings: ValueSettings) -> nn.Module:
    """Return an untrained value network."""
    return PairValue(settings.body) if settings.kind == "pairs" else AttentionValue(settings)


class PairValue(nn.Module):
    """The least of the values of the robot with each person alone (Chen et al. 2017, eq. 15);
    an empty place counts as a row of zeros.
    """

    def __init__(self, body: Sequence[int]) -> None:
        super().__init__()
        self.value = _linear_layers(OWN + PERSON, body, 1)

    def forward(self, rows: torch.Tensor) -> torch.Tensor:
        """Return values (N, 1)."""
        least: torch.Tensor = self.value(_person_pairs(rows)).amin(dim=1)
        return least


class AttentionValue(nn.Module):
    """What each pair tells, weighed by attention, and the robot's own state (Chen et al. 2019,
    section III, without local maps).
    """

    def __init__(self, settings: ValueSettings) -> None:
        super().__init__()
        wide, told = settings.body[-1], settings.told[-1]
        self.body = nn.Sequential(_linear_layers(OWN + PERSON, settings.body[:-1], wide), nn.ReLU())
        self.told = _linear_layers(wide, settings.told[:-1], told)
        self.attention = _linear_layers(2 * wide, settings.attention, 1)
        self.head = _linear_layers(OWN + told, settings.head, 1)

    def forward(self, rows: torch.Tensor) -> torch.Tensor:
        """Return values (N, 1)."""
        pairs = _person_pairs(rows)
        there = pairs[:, :, -1:]
        seen = self.body(pairs)
        mean = (seen * there).sum(dim=1, keepdim=True) / there.sum(dim=1, keepdim=True).clamp(min=1.0)
        counts = self.attention(torch.cat((seen, mean.expand_as(seen)), dim=2)).clamp(-10.0, 10.0).exp() * there
        shares = counts / counts.sum(dim=1, keepdim=True).clamp(min=1e-6)
        crowd = (shares * self.told(seen)).sum(dim=1)
        value: torch.Tensor = self.head(torch.cat((rows[:, :OWN], crowd), dim=1))
        return value


def _person_pairs(rows: torch.Tensor) -> torch.Tensor:
    """Return the robot's numbers with each person's (N, K, OWN + PERSON)."""
    people = rows[:, OWN:].reshape(rows.shape[0], -1, PERSON)
    own = rows[:, None, :OWN].expand(-1, people.shape[1], -1)
    return torch.cat((own, people), dim=2)


def _linear_layers(reads: int, widths: Sequence[int], writes: int) -> nn.Sequential:
    """Return linear layers with rectifiers in between; a single output begins at ``FIRST_VALUE``."""
    sizes = [reads, *widths]
    layers: list[nn.Module] = []
    for before, after in pairwise(sizes):
        layers += [nn.Linear(before, after), nn.ReLU()]
    last = nn.Linear(sizes[-1], writes)
    if writes == 1:
        nn.init.constant_(last.bias, FIRST_VALUE)
    return nn.Sequential(*layers, last)
