"""What a network of several hypotheses is fitted by: winner takes most, and the likelihood of the mixture."""

from __future__ import annotations

import math

import torch

from arena_prediction.hypotheses import SCALE_TIME, WIDEST

Answer = tuple[torch.Tensor, torch.Tensor, torch.Tensor]  # logits, residuals and logarithms of deviations


def way_errors(ways: torch.Tensor, truth: torch.Tensor, times: torch.Tensor) -> torch.Tensor:
    """Return the mean error over times (H,) of each hypothesis (N, M, H, 2), in the track's own speed times 1 s:
    (N, M).
    """
    off: torch.Tensor = torch.sqrt(((ways - truth[:, None]) ** 2).sum(dim=3) + 1e-8)
    return (off * (times + SCALE_TIME)).mean(dim=2)


def winner_takes_most(errors: torch.Tensor, share: float) -> torch.Tensor:
    """Return the loss of each sample (N,): the best hypothesis counts by ``share``, the others by the rest."""
    count = errors.shape[1]
    if count == 1:
        return errors[:, 0]
    best = errors.argmin(dim=1, keepdim=True)
    shares = torch.full_like(errors, (1.0 - share) / (count - 1)).scatter(1, best, share)
    return (shares * errors).sum(dim=1)


def negative_log_likelihood(answer: Answer, truth: torch.Tensor) -> torch.Tensor:
    """Return minus the logarithm of the mixture's density at the truth (N, H, 2), a time: (N,).

    A hypothesis is a way: its times are taken as independent of each other, given it, and their logarithms are
    averaged, so that weights do not collapse.
    """
    logits, ways, unsure = answer
    unsure = unsure.clamp(-WIDEST, WIDEST)
    away = (truth[:, None] - ways) * torch.exp(-unsure)
    each = -(0.5 * away**2 + unsure + 0.5 * math.log(2.0 * math.pi)).sum(dim=3).mean(dim=2)
    mixed: torch.Tensor = torch.logsumexp(torch.log_softmax(logits, dim=1) + each, dim=1)
    return -mixed


def total_loss(
    answer: Answer, truth: torch.Tensor, times: torch.Tensor, share: float, likelihood: float
) -> torch.Tensor:
    """Return the loss of a batch: winner takes most, the error of the most probable hypothesis, and the likelihood,
    which leaves the ways alone.
    """
    logits, ways, unsure = answer
    errors = way_errors(ways, truth, times)
    probable = errors.gather(1, logits.argmax(dim=1, keepdim=True))[:, 0]
    mixture = negative_log_likelihood((logits, ways.detach(), unsure), truth)
    return (winner_takes_most(errors, share) + probable + likelihood * mixture.clamp(max=50.0)).mean()
