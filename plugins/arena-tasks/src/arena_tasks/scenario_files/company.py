"""Whom the robot of a scenario file is to keep with."""

from __future__ import annotations

from typing import Any, get_args, get_type_hints

from arena_core import ConfigurationError, InputFileError
from arena_core.tasks import Company
from arena_tasks.scenario_files.json_fields import Field


def read_company(field: Field, people: int) -> Company:
    """Read ``{"manner", "person", "nearest", "farthest"}``, the person's number among so many of the problem."""
    field.check_keys("manner", "person", "nearest", "farthest")
    manner: Any = field["manner"].text()
    if manner not in (allowed := get_args(get_type_hints(Company)["manner"])):
        raise field["manner"].rejection(", ".join(allowed))
    if not people:
        raise field.rejection("a problem with people")
    person = field["person"].read_integer(0, people - 1)
    try:
        return Company(manner, person, field["nearest"].number(above=0.0), field["farthest"].number(above=0.0))
    except ConfigurationError as error:
        raise InputFileError(f"{field.file}: {field.key}.{error}") from None
