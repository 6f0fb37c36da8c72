"""The network: what is told of a track and of its neighbours, to several ways that it may take."""

from __future__ import annotations

import torch
from torch import nn

from arena_prediction.features import NEIGHBOUR_SIZE, NEIGHBOURS, OWN_SIZE
from arena_prediction.hypotheses import answer_size


class ForesightNetwork(nn.Module):
    """Answers (N, A) to numbers (N, SIZE): logits of the hypotheses' weights, their residuals, their deviations.

    Neighbours are a set: one small network reads each, their sum and maximum go on. At first it answers that all keep
    their velocity.
    """

    def __init__(self, hypotheses: int, steps: int, width: int, neighbour_width: int) -> None:
        super().__init__()
        self.hypotheses, self.steps = hypotheses, steps
        self.neighbours = nn.Sequential(
            nn.Linear(NEIGHBOUR_SIZE, neighbour_width),
            nn.ReLU(),
            nn.Linear(neighbour_width, neighbour_width),
            nn.ReLU(),
        )
        self.body = nn.Sequential(
            nn.Linear(OWN_SIZE + 2 * neighbour_width, width),
            nn.ReLU(),
            nn.Linear(width, width),
            nn.ReLU(),
        )
        self.answer = nn.Linear(width, answer_size(hypotheses, steps))
        with torch.no_grad():
            self.answer.weight.mul_(0.1)
            self.answer.bias.zero_()
            self.answer.bias[hypotheses + 2 * hypotheses * steps :] = -1.5

    def forward(self, numbers: torch.Tensor) -> torch.Tensor:
        """Return the answers."""
        others = numbers[:, OWN_SIZE:].reshape(-1, NEIGHBOURS, NEIGHBOUR_SIZE)
        read = self.neighbours(others) * others[:, :, :1]
        told = torch.cat((numbers[:, :OWN_SIZE], read.sum(dim=1), read.amax(dim=1)), dim=1)
        answers: torch.Tensor = self.answer(self.body(told))
        return answers

    def split(self, answers: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """Return logits (N, M), residuals (N, M, H, 2) and logarithms of deviations (N, M, H, 2)."""
        several, steps = self.hypotheses, self.steps
        logits, ways, unsure = torch.split(answers, [several, 2 * several * steps, 2 * several * steps], dim=1)
        shape = (-1, several, steps, 2)
        return logits, ways.reshape(shape), unsure.reshape(shape)
