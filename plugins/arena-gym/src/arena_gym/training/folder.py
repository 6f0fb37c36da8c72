"""The folder of a training: which configuration it belongs to, and what may go on in it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError
from arena_core.files import read_json, write_text_whole
from arena_core.hosting import Code, RunFolderError

CONFIG = "config.json"
CODE = "code.json"
MAY_DIFFER = ("total_steps", "device", "wandb")  # between a training and what goes on with it


def open_folder(
    folder: Path, config: Mapping[str, Any], code: Code | None = None, *, resume: bool, force: bool = False
) -> list[str]:
    """Write ``config`` and the ``code`` that trains to a new folder, or check them against those of a training that is
    gone on with.

    Returns the digests of the other code that trained there before, which ``force`` allows. Raises ConfigurationError
    for a folder that holds a training (unless ``resume``), that of another configuration, or of other code (unless
    ``force``).
    """
    file = folder / CONFIG
    if not file.exists():
        write_text_whole(file, json.dumps(config, indent=1, sort_keys=True) + "\n")
        return _write_code(folder, code)
    if not resume:
        raise ConfigurationError(
            f"{folder} holds a training already; resume=true goes on with it, out=DIR takes another folder"
        )
    differing = _first_difference(_read_mapping(file), json.loads(json.dumps(config)))
    if differing:
        raise ConfigurationError(
            f"{folder} holds a training with another {differing}; resume=true goes on only with the same one"
        )
    if code is not None and not force:
        _check_code(folder, code)
    return _write_code(folder, code)


def _check_code(folder: Path, code: Code) -> None:
    before = _read_mapping(folder / CODE) if (folder / CODE).exists() else {}
    if before.get("digest") == code.digest:
        return
    parts = before.get("parts")
    what = f": {', '.join(code.changed(parts))}" if isinstance(parts, dict) else ", which it does not name"
    raise ConfigurationError(
        f"{folder} holds a training by other code{what}; resume=force goes on with it by this code, "
        "out=DIR takes another folder"
    )


def _write_code(folder: Path, code: Code | None) -> list[str]:
    """Write the code that trains from now on, with what trained before; return that."""
    if code is None:
        return []
    before = _read_mapping(folder / CODE) if (folder / CODE).exists() else {}
    digests = [*map(str, before.get("before") or ()), str(before.get("digest", code.digest))]
    others = [digest for digest in dict.fromkeys(digests) if digest != code.digest]
    content = {"digest": code.digest, "parts": dict(code.parts), "before": others}
    write_text_whole(folder / CODE, json.dumps(content, indent=1, sort_keys=True) + "\n")
    return others


def _read_mapping(file: Path) -> dict[str, Any]:
    content = read_json(file, "the configuration of a training that `arena train` wrote")
    if not isinstance(content, dict):
        raise RunFolderError(
            f"{file}: holds no mapping; allowed: the configuration of a training that `arena train` wrote"
        )
    return content


def _first_difference(before: Mapping[str, Any], now: Mapping[str, Any]) -> str | None:
    """Return the first key in which two configurations differ, with the keys that lead to it."""
    for key in sorted((before.keys() | now.keys()) - set(MAY_DIFFER)):
        then, here = before.get(key), now.get(key)
        if then != here:
            inside = _first_difference(then, here) if isinstance(then, dict) and isinstance(here, dict) else None
            return f"{key}.{inside}" if inside else key
    return None
