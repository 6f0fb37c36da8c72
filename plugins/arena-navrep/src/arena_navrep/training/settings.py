"""The settings of a world model's training, as its YAML has them."""

from __future__ import annotations

from dataclasses import dataclass

from arena_core.parameters import NonNegative, NonNegativeInt, Positive, PositiveInt
from arena_gym.training.settings import Convolution


@dataclass(frozen=True, slots=True)
class Recording:
    """What is recorded: files of ``steps`` steps of ``worlds`` worlds, some to learn from and
    some of other worlds to be tested on.
    """

    worlds: PositiveInt
    steps: PositiveInt
    files: PositiveInt
    test_files: PositiveInt
    test_seed: NonNegativeInt
    wander: NonNegative


@dataclass(frozen=True, slots=True)
class VisionSettings:
    """A variational autoencoder of scans (Kingma and Welling 2014) and how it is fitted."""

    code: PositiveInt
    convolutions: tuple[Convolution, ...]
    noise: Positive
    near: NonNegative
    epochs: PositiveInt
    minibatch: PositiveInt
    learning_rate: Positive
    threads: PositiveInt


@dataclass(frozen=True, slots=True)
class MemorySettings:
    """A mixture density recurrent network of codes (Ha and Schmidhuber 2018) and how it is fitted."""

    hidden: PositiveInt
    mixtures: PositiveInt
    sequence: PositiveInt
    epochs: PositiveInt
    minibatch: PositiveInt
    learning_rate: Positive
    threads: PositiveInt
