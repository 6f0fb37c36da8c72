"""Outlines of what stands in scenario files."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from arena_core import InputFileError
from arena_tasks.scenario_files.json_fields import Field


def read_polygon(field: Field) -> NDArray[np.float64]:
    """Return the corners of a simple polygon with an area, (V, 2), m."""
    vertices = field.positions()
    if len(vertices) < 3:
        raise field.rejection("three or more [x, y] (m)")
    polygon = shapely.Polygon(vertices)
    if not polygon.is_valid or polygon.area == 0.0:
        raise InputFileError(
            f"{field.file}: {field.key}: {shapely.is_valid_reason(polygon)}; allowed: a simple polygon with an area"
        )
    return vertices
