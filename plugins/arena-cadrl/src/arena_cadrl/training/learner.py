"""Network, optimiser and averaged weights, and their checkpoints."""

from __future__ import annotations

import io
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from arena_cadrl.training.networks import make_network
from arena_cadrl.training.rollouts import Rollout
from arena_cadrl.training.settings import Learning, ValueSettings
from arena_core import ArenaError, ConfigurationError
from arena_core.files import write_bytes_whole

Numbers = NDArray[np.float32]
State = dict[str, Any]


class DivergedTraining(ArenaError):
    """A loss is not finite any more; the latest checkpoint is of before."""


class Learner:
    """Learns values of states; ``run`` asks the network as it is, ``averaged`` the average of its latest weights."""

    def __init__(self, network: ValueSettings, settings: Learning, seed: int, device: torch.device) -> None:
        torch.manual_seed(seed)
        self._settings, self._seed, self._device = settings, seed, device
        self.network = make_network(network).to(device)
        self.average = make_network(network).to(device)
        self.average.load_state_dict(self.network.state_dict())
        self._optimizer = torch.optim.Adam(self.network.parameters(), settings.learning_rate)
        self._rollouts: deque[Rollout] = deque(maxlen=settings.memory)

    def run(self, rows: Numbers) -> Numbers:
        """Return values (N,) of rows (N, D)."""
        return self._run_network(self.network, rows)

    def run_averaged(self, rows: Numbers) -> Numbers:
        """Return values (N,) of rows (N, D) by the averaged weights."""
        return self._run_network(self.average, rows)

    def learn(self, lesson: Rollout, number: int, left: float) -> float:
        """Learn from the latest lessons, of which this is number ``number``; return the mean loss.

        ``left`` is the share of the training that is left. Raises DivergedTraining where a loss is not finite.
        """
        self._rollouts.append(lesson)
        states = torch.from_numpy(np.concatenate([each.states for each in self._rollouts]))
        worth = torch.from_numpy(np.concatenate([each.worth for each in self._rollouts]))
        final = self._settings.final_learning_rate
        for group in self._optimizer.param_groups:
            group["lr"] = self._settings.learning_rate * (final + (1.0 - final) * left)
        random = torch.Generator().manual_seed((self._seed << 24) + number)
        losses = [self._update_weights(states, worth, random) for _ in range(self._settings.updates)]
        mean = sum(losses) / len(losses)
        if not np.isfinite(mean):
            raise DivergedTraining(f"the loss of round {number} is not finite; the checkpoint before it is kept")
        return mean

    def _update_weights(self, states: torch.Tensor, worth: torch.Tensor, random: torch.Generator) -> float:
        chosen = torch.randint(len(states), (self._settings.minibatch,), generator=random)
        missed = self.network(states[chosen].to(self._device))[:, 0] - worth[chosen].to(self._device)
        loss = missed.square().mean()
        self._optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self.network.parameters(), self._settings.max_gradient)
        self._optimizer.step()
        with torch.no_grad():
            for kept, new in zip(self.average.parameters(), self.network.parameters(), strict=True):
                kept.lerp_(new, 1.0 - self._settings.average)
        return float(loss.detach())

    def _run_network(self, network: nn.Module, rows: Numbers) -> Numbers:
        with torch.no_grad():
            parts = [network(part.to(self._device))[:, 0].cpu() for part in torch.split(torch.from_numpy(rows), 8192)]
        return np.asarray(torch.cat(parts).numpy())

    def save(self, path: Path, progress: Mapping[str, Any], best: State) -> None:
        """Write weights, optimiser, the ``best`` weights and ``progress`` (plain numbers), whole or not at all."""
        content = io.BytesIO()
        kept: dict[str, Any] = {"network": self.network, "average": self.average, "optimizer": self._optimizer}
        torch.save(
            {**{name: each.state_dict() for name, each in kept.items()}, "best": best, "progress": dict(progress)},
            content,
        )
        write_bytes_whole(path, content.getvalue())

    def load(self, path: Path) -> tuple[dict[str, Any], State]:
        """Take the weights of a checkpoint; return its progress and the best weights.

        Reads tensors and plain numbers, never code.
        """
        try:
            content = torch.load(path, weights_only=True, map_location=self._device)
            for name, each in (("network", self.network), ("average", self.average), ("optimizer", self._optimizer)):
                each.load_state_dict(content[name])
            return dict(content["progress"]), dict(content["best"])
        except Exception as error:  # whatever a damaged or foreign file raises
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise ConfigurationError(
                f"{path}: is no checkpoint of this training ({reason}); remove the folder to begin again"
            ) from error
