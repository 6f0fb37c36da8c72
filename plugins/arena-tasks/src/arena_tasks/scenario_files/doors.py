"""Doors of scenario files, which open and close by a timetable."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from arena_core import ConfigurationError, InputFileError
from arena_core.scenes import Door
from arena_tasks.scenario_files.json_fields import Field
from arena_tasks.scenario_files.outlines import read_polygon

INTERVALS = "[from, to] or [from] (s; without an end it stays open)"


def read_door(field: Field) -> Door:
    """Read ``{"vertices", "open", "period"}``; raise InputFileError for times that have no order."""
    field.check_keys("vertices", "open", "period")
    intervals = [_read_interval(pair) for pair in field["open"].items()]
    if not intervals:
        raise field["open"].rejection(f"one or more {INTERVALS}")
    period = field["period"].number(above=0.0) if field.has("period") else None
    try:
        return Door(read_polygon(field["vertices"]), np.array(intervals), period)
    except ConfigurationError as error:
        raise InputFileError(f"{field.file}: {field.key}.{error}") from None


def _read_interval(field: Field) -> tuple[float, float]:
    match field.items():
        case [begin]:
            return begin.number(low=0.0), math.inf
        case [begin, end]:
            return begin.number(low=0.0), end.number(above=0.0)
    raise field.rejection(INTERVALS)


def door_entry(door: Door) -> dict[str, Any]:
    """Return a door as scenario files have it."""
    intervals = [[begin, end] if math.isfinite(end) else [begin] for begin, end in door.open.tolist()]
    entry = {"vertices": door.vertices_xy.tolist(), "open": intervals}
    return entry if door.period is None else {**entry, "period": door.period}
