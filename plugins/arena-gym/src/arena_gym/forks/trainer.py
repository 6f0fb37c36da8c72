"""``trainer.name=switch_forks``: a switch learns what each member costs from forks of the states that it meets."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import nn

from arena_core import ConfigurationError
from arena_core.files import write_bytes_whole
from arena_core.hosting import Trainer
from arena_core.parameters import NonNegativeInt, read_settings
from arena_gym.building import Parts, build_parts
from arena_gym.forks.collecting import Collector
from arena_gym.forks.costs import total_costs
from arena_gym.forks.fitting import Lessons, fit_networks
from arena_gym.forks.scoring import describe_score, score_choices
from arena_gym.forks.settings import CostSettings, DriveSettings, FitSettings
from arena_gym.training.export import network_to_onnx
from arena_gym.training.folder import open_folder
from arena_gym.training.session import PACKAGES, make_card, training_settings
from arena_policies.card import write_card


class ForkTrainer(Trainer):
    """Drives by members that are drawn, forks the world and the robot's brain once for each member at every so many
    seconds, and fits what a switch sees to what each of them then cost.
    """

    def __init__(self, drives: DriveSettings, costs: CostSettings, fit: FitSettings) -> None:
        self._drives, self._costs, self._fit = drives, costs, fit

    def train(self, config: Mapping[str, Any], folder: Path, *, resume: bool) -> None:
        """Collect states, fit, and write ``policy.onnx`` with its card to ``folder``."""
        seed = read_settings(config["seed"], NonNegativeInt, "seed")
        parts, chosen = build_parts(config), training_settings(config)
        if parts.switch is None:
            raise ConfigurationError("switch is null; allowed with forks: one, whose members are chosen among")
        open_folder(folder, config, resume=resume)
        states = Collector(config, self._drives, self._costs, seed).collect(folder / "states")
        if len(np.unique(states.block)) < self._fit.folds:
            raise ConfigurationError(
                f"{folder}: {len(np.unique(states.block))} blocks have states; allowed: trainer.fit.folds "
                f"({self._fit.folds}) at least, by more trainer.drives.blocks or episodes"
            )
        torch.set_num_threads(chosen.threads)
        torch.manual_seed(seed)
        lessons = Lessons(states.numbers, total_costs(states.terms, self._costs), states.block)
        fitted = fit_networks(lessons, parts.encoder.layout(), self._fit, chosen.network)
        score = score_choices(lessons.costs, fitted.unseen, states.block, tuple(parts.switch.members))
        print(describe_score(score), flush=True)
        told = {
            "seed": seed,
            "config": dict(config),
            "forks": {"states": len(states.numbers), "horizon": self._costs.horizon},
            "score": score,
            "versions": {name: version(name) for name in PACKAGES},
        }
        _export(parts, fitted.network, told, folder)


def _export(parts: Parts, network: nn.Module, told: Mapping[str, Any], folder: Path) -> None:
    """Write a network and its card, which tells of the training."""
    content = network_to_onnx(network, sum(field.size for field in parts.encoder.layout()), "observation", "action")
    write_bytes_whole(folder / "policy.onnx", content)
    write_card(folder / "policy.json", make_card(parts.config, parts, parts.robot.name, content, told))
    print(f"policy: {folder / 'policy.onnx'}")
