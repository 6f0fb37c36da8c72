"""Fitting the network by epochs, with a checkpoint after each; what was cut off goes on as if it had not been."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from arena_core import ConfigurationError
from arena_gym.prediction.losses import total_loss
from arena_gym.prediction.network import ForesightNetwork
from arena_gym.prediction.samples import Samples
from arena_gym.prediction.settings import FitSettings
from arena_gym.training.fit_checkpoint import Curve, load_fit, save_fit

STEEPEST = 5.0  # norm of a gradient, at most


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """What a network is fitted to, how, and which folder keeps checkpoint and curve."""

    samples: Samples
    settings: FitSettings
    seed: int
    folder: Path


def fit_network(network: ForesightNetwork, fit: Fit, score: Callable[[], dict[str, float]]) -> Curve:
    """Fit a network and return the curve of its scores, an epoch each; raise ConfigurationError once one is no number.

    Every random number of an epoch comes from a generator keyed by seed and epoch.
    """
    settings = fit.settings
    optimizer = torch.optim.AdamW(network.parameters(), settings.rate, weight_decay=settings.decay)
    curve = load_fit(fit.folder, network, optimizer)
    for epoch in range(len(curve), settings.epochs):
        row = {"epoch": epoch + 1, "loss": _run_epoch(network, optimizer, fit, epoch), **score()}
        if not all(map(math.isfinite, row.values())):
            raise ConfigurationError(
                f"trainer.fit.rate is {settings.rate:g}, and epoch {epoch + 1} has a loss that is no number; "
                "allowed: a smaller one, with out=DIR"
            )
        curve.append(row)
        print(", ".join(f"{name} {value:.4g}" for name, value in row.items()), flush=True)
        save_fit(fit.folder, network, optimizer, curve)
    return curve


def epoch_order(true: NDArray[np.bool_], share: float, draw: np.random.Generator) -> NDArray[np.int64]:
    """Return the samples of an epoch in order: all of the tracker's, and so many of true tracks that these are
    ``share`` of them, as far as there are as many.
    """
    tracked, others = np.flatnonzero(~true), np.flatnonzero(true)
    count = len(others) if share >= 1.0 else min(len(others), round(len(tracked) * share / (1.0 - share)))
    kept = tracked if share < 1.0 else tracked[:0]
    return draw.permutation(np.concatenate((kept, draw.choice(others, count, replace=False) if count else others[:0])))


def _run_epoch(network: ForesightNetwork, optimizer: torch.optim.Optimizer, fit: Fit, epoch: int) -> float:
    """Learn from all samples once, the rate falling along a cosine over the whole training; return the mean loss."""
    samples, settings = fit.samples, fit.settings
    order = epoch_order(samples.true, settings.true_share, np.random.default_rng((fit.seed, epoch)))
    times = settings.step * torch.arange(1, settings.times + 1)
    batches = [order[k : k + settings.batch] for k in range(0, len(order), settings.batch)]
    total = 0.0
    for place, rows in enumerate(batches):
        done = (epoch + place / len(batches)) / settings.epochs
        for group in optimizer.param_groups:
            group["lr"] = 0.5 * settings.rate * (1.0 + math.cos(math.pi * done))
        answer = network.split(network(torch.from_numpy(samples.numbers[rows])))
        truth = torch.from_numpy(samples.residuals[rows])
        loss = total_loss(answer, truth, times, settings.share, settings.likelihood)
        optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        nn.utils.clip_grad_norm_(network.parameters(), STEEPEST)
        optimizer.step()
        total += float(loss.detach())
    return total / max(len(batches), 1)
