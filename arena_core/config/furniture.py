"""Kinds of furniture: the options of conf/furniture, and of that folder in plugins and in your own ./conf."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from arena_core.base.errors import ConfigurationError
from arena_core.config.binding import read_settings
from arena_core.config.configuration import compose, to_plain
from arena_core.config.option_folders import option_files
from arena_core.config.plugins import load_plugins
from arena_core.values.furniture import FurnitureKind


def furniture_kind(name: str) -> FurnitureKind:
    """Return a kind of furniture; raise ConfigurationError for one that is not there or malformed."""
    return _read_kind(name, Path.cwd())  # whose ./conf may have more


@lru_cache(maxsize=64)
def _read_kind(name: str, _: Path) -> FurnitureKind:
    kinds = option_files("furniture", load_plugins())
    if name not in kinds:
        raise ConfigurationError(f"furniture is {name!r}; allowed: {', '.join(kinds)}")
    return read_settings(
        to_plain(compose([f"+furniture={name}"], "component"))["furniture"], FurnitureKind, f"furniture.{name}"
    )
