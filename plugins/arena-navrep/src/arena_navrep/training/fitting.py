"""Fitting a network by epochs, with a checkpoint after each; what was cut off goes on as if it had not been."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import torch
from torch import nn

from arena_core import ConfigurationError
from arena_gym.training.fit_checkpoint import Curve, load_fit, save_fit

FINAL_SHARE = 0.05  # of the learning rate, at the end


def fit_network(
    network: nn.Module,
    losses: Callable[[torch.Generator], Iterator[torch.Tensor]],
    score: Callable[[], dict[str, float]],
    epochs: int,
    learning_rate: float,
    seed: int,
    folder: Path,
) -> Curve:
    """Fit a network to the losses of each epoch's minibatches; return the curve of its scores, an epoch each.

    Every random number of an epoch comes from a generator keyed by seed and epoch. ``folder`` keeps checkpoint and
    curve. Raises ConfigurationError once a score is no number.
    """
    optimizer = torch.optim.Adam(network.parameters(), learning_rate)
    curve = load_fit(folder, network, optimizer)
    for epoch in range(len(curve), epochs):
        for group in optimizer.param_groups:
            group["lr"] = learning_rate * (1.0 - (1.0 - FINAL_SHARE) * epoch / epochs)
        random = torch.Generator().manual_seed((seed << 16) + epoch)
        total = [_gradient_step(network, optimizer, loss) for loss in losses(random)]
        row = {"epoch": epoch + 1, "loss": sum(total) / len(total), **score()}
        if not all(map(math.isfinite, row.values())):
            rate = (
                f"the learning rate of {folder.name} is {learning_rate:g}, "
                f"and in epoch {epoch + 1} it is no number how far off it is"
            )
            raise ConfigurationError(f"{rate}; allowed: a smaller one, with out=DIR")
        curve.append(row)
        print(", ".join(f"{name} {value:.4g}" for name, value in curve[-1].items()), flush=True)
        save_fit(folder, network, optimizer, curve)
    return curve


def _gradient_step(network: nn.Module, optimizer: torch.optim.Optimizer, loss: torch.Tensor) -> float:
    optimizer.zero_grad()
    loss.backward()  # type: ignore[no-untyped-call]
    nn.utils.clip_grad_norm_(network.parameters(), 10.0)
    optimizer.step()
    return float(loss.detach())
