"""Furniture of scenario files: a kind of conf/furniture, and where it stands."""

from __future__ import annotations

from typing import Any

from arena_core import ConfigurationError, Furniture, InputFileError
from arena_core.commands import one_line
from arena_core.scenes import furniture_kind
from arena_tasks.scenario_files.json_fields import Field


def read_piece(field: Field) -> Furniture:
    """Return a piece of furniture; raise InputFileError for a kind that is not there."""
    field.check_keys("kind", "pose")
    name = field["kind"].text()
    try:
        return furniture_kind(name).at(name, field["pose"].pose())
    except ConfigurationError as error:
        raise InputFileError(f"{field.file}: {field.key}.kind: {one_line(str(error), 300)}") from None


def piece_entry(piece: Furniture) -> dict[str, Any]:
    """Return a piece as scenario files have it."""
    return {"kind": piece.kind, "pose": piece.pose.array().tolist()}
