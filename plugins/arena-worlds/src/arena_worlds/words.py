"""The words of ``arena world``'s subcommands: KEY=VALUE as in Hydra's overrides, and the names of files."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from arena_core import ConfigurationError


def key_values(words: Sequence[str]) -> dict[str, str]:
    """Return KEY=VALUE words as a mapping; raise ConfigurationError for a word without a key, and for one key given twice."""
    found: dict[str, str] = {}
    for word in words:
        key, equals, value = word.partition("=")
        if not key or not equals or key in found:
            reason = "is given twice" if equals and key in found else "cannot be read"
            raise ConfigurationError(f"{word} {reason}; allowed: KEY=VALUE, each key once")
        found[key] = value
    return found


def required(words: Mapping[str, str], key: str, allowed: str) -> str:
    """Return the value of ``key``; raise ConfigurationError where it is missing or empty."""
    if not words.get(key):
        raise ConfigurationError(f"{key} is missing; allowed: {key}={allowed}")
    return words[key]


def whole_number(words: Mapping[str, str], key: str, default: int) -> int:
    """Return ``key`` as a whole number of at least 0; raise ConfigurationError."""
    text = words.get(key, str(default))
    if not (text.isascii() and text.isdigit()):
        raise ConfigurationError(f"{key} is {text!r}; allowed: a whole number of at least 0")
    return int(text)


def measure(words: Mapping[str, str], key: str, default: float) -> float:
    """Return ``key`` as a length, m; raise ConfigurationError for one that is none or not above 0."""
    text = words.get(key, str(default))
    try:
        length = float(text)
    except ValueError:
        length = math.nan
    if not 0.0 < length < math.inf:
        raise ConfigurationError(f"{key} is {text!r}; allowed: a number > 0 (m)")
    return length


def map_path(out: str) -> Path:
    """Return the YAML file of a map to write: ``out`` itself if it ends in .yaml, else map.yaml in the folder ``out``."""
    path = Path(out)
    return path if path.suffix == ".yaml" else path / "map.yaml"
