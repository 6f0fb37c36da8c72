"""M: a recurrent network that foresees the next code as a mixture of Gaussians (Ha and Schmidhuber 2018),
of gated recurrent units.
"""

from __future__ import annotations

import torch
from torch import nn

LOG_STD = -5.0, 2.0  # bounds of what a Gaussian of the mixture may be


class Memory(nn.Module):
    """Remembers codes and motions (N, Z + K) in a memory (N, H) that lies within -1 .. 1.

    Gated recurrent units (Cho et al. 2014) have no state beside the memory that the controller sees.
    """

    def __init__(self, code: int, motion: int, hidden: int, mixtures: int) -> None:
        super().__init__()
        self.code, self.hidden, self._read, self._mixtures = code, hidden, code + motion, mixtures
        self.taken, self.kept = nn.Linear(self._read, 3 * hidden), nn.Linear(hidden, 3 * hidden)
        self.head = nn.Linear(hidden, 3 * mixtures * code)

    def step(self, taken: torch.Tensor, hidden: torch.Tensor) -> torch.Tensor:
        """Return the next memory (N, H) from ``taken`` (N, 3 H), what a code and a
        motion weigh, and the memory before.
        """
        reset, update, fresh = taken.chunk(3, dim=-1)
        kept_reset, kept_update, kept_fresh = self.kept(hidden).chunk(3, dim=-1)
        share = torch.sigmoid(update + kept_update)
        candidate = torch.tanh(fresh + torch.sigmoid(reset + kept_reset) * kept_fresh)
        return share * hidden + (1.0 - share) * candidate

    def unroll_memory(self, inputs: torch.Tensor, begins: torch.Tensor) -> torch.Tensor:
        """Return the memories (T, N, H) of inputs (T, N, Z + K); where an episode
        begins, (T, N), nothing is remembered.
        """
        taken = self.taken(inputs)
        hidden = inputs.new_zeros(inputs.shape[1], self.hidden)
        memories = []
        for k in range(len(inputs)):
            hidden = self.step(taken[k], hidden * ~begins[k].unsqueeze(1))
            memories.append(hidden)
        return torch.stack(memories)

    def code_mixture(
        self, memories: torch.Tensor, before: torch.Tensor
    ) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """Return log weights, means and log standard deviations (..., Z, M) of the next code, whose means
        count from the code before.
        """
        shares, changes, log_stds = self.head(memories).unflatten(-1, (3, self.code, self._mixtures)).unbind(-3)
        return shares.log_softmax(-1), before.unsqueeze(-1) + changes, log_stds.clamp(*LOG_STD)

    def expected_codes(self, memories: torch.Tensor, before: torch.Tensor) -> torch.Tensor:
        """Return the next codes (..., Z) that are expected."""
        log_shares, means, _ = self.code_mixture(memories, before)
        return (log_shares.exp() * means).sum(-1)

    def negative_log_likelihood(
        self, memories: torch.Tensor, before: torch.Tensor, codes: torch.Tensor
    ) -> torch.Tensor:
        """Return the negative log likelihood (...) of the codes that came."""
        log_shares, means, log_stds = self.code_mixture(memories, before)
        missed = (codes.unsqueeze(-1) - means) * (-log_stds).exp()
        return -(log_shares - log_stds - 0.5 * missed.square()).logsumexp(-1).sum(-1)

    def forward(self, numbers: torch.Tensor) -> torch.Tensor:
        """Return memory and expected next code (N, H + Z) for code, motion and memory
        (N, Z + K + H) of the step before.
        """
        inputs, hidden = numbers[:, : self._read], numbers[:, self._read :]
        memory = self.step(self.taken(inputs), hidden)
        return torch.cat((memory, self.expected_codes(memory, inputs[:, : self.code])), dim=1)
