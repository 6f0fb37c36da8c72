"""The folder of a tuning: which request it belongs to, and whether it may go on there."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError
from arena_core.files import read_json, write_text_whole

NAME = "settings.json"
STORAGE = "study.db"  # Optuna's study
# what is noted in it beside what Optuna is told: episodes of a trial, importance of parameters after the last race
EPISODES, IMPORTANCE = "episodes", "importance"


def open_folder(folder: Path, settings: Mapping[str, Any], *, resume: bool) -> None:
    """Write the settings of a tuning to a new folder, or check them against those that are there.

    Raises ConfigurationError for a folder that holds a tuning (unless ``resume``), or one of another request or code.
    """
    file, wanted = folder / NAME, json.loads(json.dumps(settings))
    if not file.exists():
        write_text_whole(file, json.dumps(wanted, indent=1, sort_keys=True) + "\n")
        return
    if not resume:
        raise ConfigurationError(
            f"{folder} holds a tuning already; resume=true goes on with it, out=DIR is another one"
        )
    before = read_json(file, "what `arena tune` wrote")
    then = before if isinstance(before, dict) else {}
    changed = [key for key in sorted(wanted.keys() | then.keys()) if then.get(key) != wanted.get(key)]
    if changed:
        raise ConfigurationError(
            f"{folder} holds a tuning with another {changed[0]}; resume=true goes on with the same one alone"
        )
