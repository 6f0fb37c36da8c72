"""The folder of a training: which configuration it belongs to, and what may go on in it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError, RunFolderError, read_json, write_text_whole

CONFIG = "config.json"
MAY_DIFFER = ("total_steps", "device")  # between a training and what goes on with it


def open_folder(folder: Path, config: Mapping[str, Any], resume: bool) -> None:
    """Write ``config`` to a new folder, or check it against the one of a training that is gone on with.

    Raises ConfigurationError for a folder that holds a training (unless ``resume``), or that of another configuration.
    """
    file = folder / CONFIG
    if not file.exists():
        write_text_whole(file, json.dumps(config, indent=1, sort_keys=True) + "\n")
        return
    if not resume:
        raise ConfigurationError(f"{folder} holds a training already; resume=true goes on with it, out=DIR takes another folder")
    differing = _differing(_read(file), json.loads(json.dumps(config)))
    if differing:
        raise ConfigurationError(f"{folder} holds a training with another {differing}; resume=true goes on only with the same one")


def _read(file: Path) -> dict[str, Any]:
    content = read_json(file, "the configuration of a training that `arena train` wrote")
    if not isinstance(content, dict):
        raise RunFolderError(f"{file}: holds no mapping; allowed: the configuration of a training that `arena train` wrote")
    return content


def _differing(before: Mapping[str, Any], now: Mapping[str, Any]) -> str | None:
    """Return the first key in which two configurations differ."""
    keys = sorted((before.keys() | now.keys()) - set(MAY_DIFFER))
    return next((key for key in keys if before.get(key) != now.get(key)), None)
