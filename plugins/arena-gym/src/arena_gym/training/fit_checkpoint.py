"""Checkpoints of networks that are fitted by epochs: weights, optimiser and the curve of scores."""

from __future__ import annotations

import io
import json
from pathlib import Path

import torch
from torch import nn

from arena_core.files import write_bytes_whole, write_text_whole
from arena_gym.training.checkpoint import checkpoint_errors

CHECKPOINT, CURVE = "checkpoint.pt", "curve.json"
Curve = list[dict[str, float]]  # an epoch each


def save_fit(folder: Path, network: nn.Module, optimizer: torch.optim.Optimizer, curve: Curve) -> None:
    """Write checkpoint and curve to a training's folder."""
    content = io.BytesIO()
    torch.save({"network": network.state_dict(), "optimizer": optimizer.state_dict(), "curve": curve}, content)
    write_bytes_whole(folder / CHECKPOINT, content.getvalue())
    write_text_whole(folder / CURVE, json.dumps(curve, indent=1) + "\n")


def load_fit(folder: Path, network: nn.Module, optimizer: torch.optim.Optimizer) -> Curve:
    """Give network and optimiser what the folder's checkpoint holds, if there is one, and return its curve; raise
    ConfigurationError for one of another training.
    """
    path = folder / CHECKPOINT
    if not path.exists():
        return []
    with checkpoint_errors(path):
        content = torch.load(path, weights_only=True, map_location="cpu")
        network.load_state_dict(content["network"])
        optimizer.load_state_dict(content["optimizer"])
        return list(content["curve"])
