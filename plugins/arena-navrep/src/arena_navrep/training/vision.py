"""V: a variational autoencoder of scans (Kingma and Welling 2014; in a world model: Ha and Schmidhuber 2018)."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import nn
from torch.nn import functional

from arena_core import ConfigurationError
from arena_gym.training.settings import Convolution
from arena_navrep.world_model import CODE_MAX


class Vision(nn.Module):
    """Codes scans (N, S) by convolutions, and makes scans of codes (N, Z) by the same ones transposed.

    What it draws may miss a scan's closeness c by a standard deviation of ``noise`` exp(-``near`` c / 2): with ``near``
    more of the code goes to what is close to the robot.
    """

    def __init__(self, beams: int, code: int, convolutions: Sequence[Convolution], noise: float, near: float) -> None:
        super().__init__()
        self._noise, self._near = noise, near
        channels = [1, *(layer.channels for layer in convolutions)]
        self._lengths = [beams]
        for layer in convolutions:
            self._lengths.append((self._lengths[-1] - layer.kernel) // layer.stride + 1)
        if self._lengths[-1] < 1:
            raise ConfigurationError(
                f"vision.convolutions leave nothing of {beams} beams; allowed: fewer or smaller ones"
            )
        shapes = [(a, b, c.kernel, c.stride) for a, b, c in zip(channels, channels[1:], convolutions, strict=False)]
        self.seeing = nn.ModuleList(nn.Conv1d(a, b, kernel, stride) for a, b, kernel, stride in shapes)
        self.drawing = nn.ModuleList(
            nn.ConvTranspose1d(b, a, kernel, stride) for a, b, kernel, stride in reversed(shapes)
        )
        self._deep = channels[-1], self._lengths[-1]
        wide = channels[-1] * self._lengths[-1]
        self.mean, self.log_variance = nn.Linear(wide, code), nn.Linear(wide, code)
        self.grown = nn.Linear(code, wide)

    def forward(self, scans: torch.Tensor) -> torch.Tensor:
        """Return the codes (N, Z) that a controller sees: the means, within bounds."""
        return self._code_posterior(scans)[0].clamp(-CODE_MAX, CODE_MAX)

    def decode(self, codes: torch.Tensor) -> torch.Tensor:
        """Return the scans (N, S) that codes stand for."""
        drawn: torch.Tensor = functional.relu(self.grown(codes)).reshape(-1, *self._deep)
        for place, layer in enumerate(self.drawing):
            drawn = layer(drawn, output_size=[self._lengths[-2 - place]])
            drawn = drawn if place == len(self.drawing) - 1 else functional.relu(drawn)
        return drawn.squeeze(1)

    def loss(self, scans: torch.Tensor, random: torch.Generator) -> torch.Tensor:
        """Return the negative evidence lower bound of scans (N, S), on average, but for what does
        not depend on the network.
        """
        mean, log_variance = self._code_posterior(scans)
        noise = torch.randn(mean.shape, generator=random).to(mean.device)
        missed = self.decode(mean + (0.5 * log_variance).exp() * noise) - scans
        granted = self._noise * (-0.5 * self._near * scans).exp()
        surprise = 0.5 * (missed / granted).square().sum(dim=1)
        divergence = 0.5 * (mean.square() + log_variance.exp() - 1.0 - log_variance).sum(dim=1)
        return (surprise + divergence).mean()

    def _code_posterior(self, scans: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        seen = scans.unsqueeze(1)
        for layer in self.seeing:
            seen = functional.relu(layer(seen))
        flat = seen.flatten(1)
        return self.mean(flat), self.log_variance(flat).clamp(-10.0, 4.0)
