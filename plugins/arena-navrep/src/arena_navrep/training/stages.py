"""The stages of a world model's training, from roll-outs to vision to memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import nn

from arena_core import ObservationField, Robot
from arena_core.hosting import load_registry
from arena_core.parameters import read_settings
from arena_gym.training.export import network_to_onnx
from arena_gym.training.fit_checkpoint import Curve
from arena_gym.training.learning import choose_device
from arena_navrep.prediction import Sequences, prediction_errors, sequences_of
from arena_navrep.rollouts import Rollouts, read_rollouts
from arena_navrep.training.fitting import fit_network
from arena_navrep.training.memory import Memory
from arena_navrep.training.recording import record_missing
from arena_navrep.training.settings import MemorySettings, Recording, VisionSettings
from arena_navrep.training.vision import Vision
from arena_navrep.world_model import PartCard, load_part, write_part
from arena_policies.card import content_sha256

PACKAGES = ("arena-core", "arena-gym", "arena-navrep", "arena-policies", "arena-sim2d", "arena-crowds", "torch", "onnx")


def check_settings(config: Mapping[str, Any]) -> None:
    """Raise ConfigurationError where a setting is not possible, before anything is written."""
    for section, settings in (("recording", Recording), ("vision", VisionSettings), ("memory", MemorySettings)):
        read_settings(config[section], settings, section)
    choose_device(config["device"])


def record_rollouts(config: Mapping[str, Any], folder: Path) -> None:
    """Record what the world model learns from."""
    record_missing(config, read_settings(config["recording"], Recording, "recording"), folder)


def fit_vision(config: Mapping[str, Any], folder: Path) -> None:
    """Fit V to the scans of the roll-outs; write ``vision.onnx`` and its card."""
    settings = read_settings(config["vision"], VisionSettings, "vision")
    device = _prepare_torch(config, settings.threads)
    train, test = (rollouts.scans.reshape(-1, rollouts.scans.shape[2]) for rollouts in _load_rollouts(config, folder))
    vision = Vision(train.shape[1], settings.code, settings.convolutions, settings.noise, settings.near).to(device)
    scans = torch.from_numpy(train)

    def losses(random: torch.Generator) -> Iterator[torch.Tensor]:
        for chosen in torch.split(torch.randperm(len(scans), generator=random), settings.minibatch):
            yield vision.loss(scans[chosen].to(device), random)

    def score() -> dict[str, float]:
        with torch.no_grad():
            seen = torch.from_numpy(test)
            drawn = torch.cat([vision.decode(vision(part.to(device))).cpu() for part in torch.split(seen, 4096)])
        return {
            "error": float((drawn - seen).square().mean().sqrt()),
            "spread": float((seen - seen.mean(dim=0)).square().mean().sqrt()),
        }

    curve = fit_network(
        vision, losses, score, settings.epochs, settings.learning_rate, config["seed"], folder / "vision"
    )
    content = network_to_onnx(vision, train.shape[1], "scan", "code")
    sizes, channels = (train.shape[1], settings.code), ", ".join(str(layer.channels) for layer in settings.convolutions)
    shrunk = (
        f"convolutions of {channels} channels over {train.shape[1]} sectors in place of 32 .. 256 over 1080 beams; "
        "structure kept"
    )
    write_part(
        folder / "vision.onnx",
        content,
        _make_card("vision", config, content, sizes, settings.code, 0, content_sha256(content), shrunk, curve),
    )


def fit_memory(config: Mapping[str, Any], folder: Path) -> None:
    """Fit M to the codes that V gives the roll-outs; write ``memory.onnx`` and its card."""
    settings = read_settings(config["memory"], MemorySettings, "memory")
    device = _prepare_torch(config, settings.threads)
    vision = load_part(str(folder / "vision.onnx"), "vision")
    train, test = (sequences_of(rollouts, vision, _scan_layout(config)) for rollouts in _load_rollouts(config, folder))
    memory = Memory(vision.card.code, train.motions.shape[2], settings.hidden, settings.mixtures).to(device)
    windows = _training_windows(train, settings.sequence)

    def losses(random: torch.Generator) -> Iterator[torch.Tensor]:
        for chosen in torch.split(torch.randperm(windows[0].shape[1], generator=random), settings.minibatch):
            yield _mean_loss(memory, *(part[:, chosen].to(device) for part in windows))

    def score() -> dict[str, float]:
        return prediction_errors(test, lambda numbers: _run_network(memory, numbers, device), settings.hidden)

    curve = fit_network(
        memory, losses, score, settings.epochs, settings.learning_rate, config["seed"], folder / "memory"
    )
    reads = vision.card.code + train.motions.shape[2] + settings.hidden
    content = network_to_onnx(memory, reads, "recalled", "remembered")
    sizes = reads, settings.hidden + vision.card.code
    shrunk = f"gated recurrent units of {settings.hidden} in place of an LSTM of 512; structure kept"
    card = _make_card(
        "memory", config, content, sizes, vision.card.code, settings.hidden, vision.card.sha256, shrunk, curve
    )
    write_part(folder / "memory.onnx", content, card)


def _prepare_torch(config: Mapping[str, Any], threads: int) -> torch.device:
    torch.set_num_threads(threads)
    torch.manual_seed(config["seed"])
    return choose_device(config["device"])


def _load_rollouts(config: Mapping[str, Any], folder: Path) -> tuple[Rollouts, Rollouts]:
    settings = read_settings(config["recording"], Recording, "recording")
    return read_rollouts(folder, "train", settings.files), read_rollouts(folder, "test", settings.test_files)


def _scan_layout(config: Mapping[str, Any]) -> tuple[ObservationField, ...]:
    """Return the fields that the robot's scans have here."""
    registry = load_registry()
    robot: Robot = registry.build("robot", config["robot"])
    fields: tuple[ObservationField, ...] = registry.build(
        "observation_encoder", config["observation_encoder"], robot=robot
    ).layout()
    return fields


def _training_windows(sequences: Sequences, steps: int) -> tuple[torch.Tensor, ...]:
    """Return inputs (T, W, Z + K), begins, codes before and codes of stretches of ``steps``
    steps, those of all robots side by side.
    """
    arrays = (
        np.concatenate((sequences.before, sequences.motions), axis=2),
        sequences.begins,
        sequences.before,
        sequences.codes,
    )
    length = len(sequences.codes)
    steps = min(steps, length)
    starts = range(0, length - steps + 1, steps)
    return tuple(torch.from_numpy(np.concatenate([array[k : k + steps] for k in starts], axis=1)) for array in arrays)


def _mean_loss(
    memory: Memory, inputs: torch.Tensor, begins: torch.Tensor, before: torch.Tensor, codes: torch.Tensor
) -> torch.Tensor:
    """Return the mean surprise; what comes first in an episode cannot be foreseen."""
    surprise = memory.negative_log_likelihood(memory.unroll_memory(inputs, begins), before, codes)
    return (surprise * ~begins).sum() / (~begins).sum()


def _run_network(
    network: nn.Module, numbers: np.ndarray[Any, np.dtype[np.float32]], device: torch.device
) -> np.ndarray[Any, Any]:
    with torch.no_grad():
        return np.asarray(network(torch.from_numpy(numbers).to(device)).cpu().numpy())


def _make_card(
    part: str,
    config: Mapping[str, Any],
    content: bytes,
    sizes: tuple[int, int],
    code: int,
    hidden: int,
    vision: str,
    shrunk: str,
    curve: Curve,
) -> PartCard:
    training = {
        "seed": config["seed"],
        "shrunk": shrunk,
        "curve": curve,
        "config": {key: value for key, value in config.items() if part == "memory" or key != "memory"},
        "versions": {name: version(name) for name in PACKAGES},
    }
    own = config["robot"]["name"], config["observation_encoder"], _scan_layout(config)
    return PartCard(part, *own, *sizes, code, hidden, vision, content_sha256(content), training)
