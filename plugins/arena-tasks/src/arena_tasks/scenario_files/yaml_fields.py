"""YAML whose every value knows its file and key, as json_fields has it for JSON."""

from __future__ import annotations

from pathlib import Path

from arena_core import files
from arena_tasks.scenario_files.json_fields import Field


def read_yaml(path: Path, allowed: str) -> Field:
    """Read a YAML file; raise InputFileError, which names ``allowed`` as what may be there."""
    return Field(path, "", files.read_yaml(path, allowed))
