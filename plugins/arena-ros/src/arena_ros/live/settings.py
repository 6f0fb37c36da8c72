"""The figures of ``live.yaml``, each of which the command line may change."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TypeVar

from arena_core.commands import Words
from arena_core.files import read_yaml
from arena_core.parameters import Fraction, Positive, read_settings


@dataclass(frozen=True, slots=True)
class Settings:
    """Ages and periods in s; ``overrun`` in control periods, ``speed`` a share."""

    scan_age: Positive
    odometry_age: Positive
    pose_age: Positive
    overrun: Positive
    patience: Positive
    speed: Fraction
    status_period: Positive
    watchdog_age: Positive
    watchdog_period: Positive
    sensor_period: Positive


T = TypeVar("T")


def live_settings(words: Words) -> Settings:
    """Return the figures, those of the command line first; raise ConfigurationError."""
    return read_figures(words, "live.yaml", Settings)


def read_figures(words: Words, file: str, kind: type[T]) -> T:
    """Return the figures of a file of this package, those of the command line first; raise ConfigurationError."""
    usual: Mapping[str, float] = read_yaml(Path(str(files("arena_ros") / file)), "the figures of this package")
    said = {key: words.value(key, float, value) for key, value in usual.items()}
    return read_settings(said, kind, "")
