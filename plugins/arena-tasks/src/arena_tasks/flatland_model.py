"""The shapes of a Flatland model, as arena-tools' static obstacles name it by its file."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

import numpy as np
import shapely
from numpy.typing import NDArray

from arena_core import Obstacle, Pose
from arena_tasks.json_fields import Field
from arena_tasks.yaml_fields import read_yaml

FOLDERS = (".", "obstacles", "../obstacles")  # from the scenario's folder; the last is where arena-rosnav has them


def placed_model(obstacle: Field) -> list[Obstacle]:
    """Return the shapes of a static obstacle of arena-tools: ``model_path`` at ``pos``, turned by ``angle``.

    Of the path the file's name counts: it is sought as it stands and then in FOLDERS. Raises InputFileError.
    """
    x, y = obstacle["pos"].position().tolist()
    place = Pose(x, y, obstacle["angle"].number() if obstacle.has("angle") else 0.0)
    model = read_yaml(_model_file(obstacle["model_path"]), "a Flatland model")
    return [shape for body in model["bodies"].items() for shape in _shapes(body, place)]


def _model_file(stated: Field) -> Path:
    path = PurePosixPath(stated.text().replace("\\", "/").replace("\0", ""))
    if Path(path).is_file():
        return Path(path)
    places = [stated.file.parent / folder / path.name for folder in FOLDERS]
    for place in places:
        if place.is_file():
            return place
    raise stated.refused(f"a Flatland model that is there (looked for {', '.join(map(str, places))})")


def _shapes(body: Field, place: Pose) -> Iterator[Obstacle]:
    """Yield the footprints of a body that can be hit, in ``map``."""
    at = place.compose(body["pose"].pose()) if body.has("pose") else place
    for footprint in body["footprints"].items():
        if footprint.has("collision") and footprint["collision"].value is False:
            continue
        if footprint["type"].value == "circle":
            centre = footprint["center"].position() if footprint.has("center") else np.zeros(2)
            yield Obstacle(_moved(centre[None], at), footprint["radius"].number(above=0.0))
        elif footprint["type"].value == "polygon":
            yield Obstacle(_moved(convex(footprint["points"]), at))
        else:
            raise footprint["type"].refused("circle or polygon")


def convex(points: Field) -> NDArray[np.float64]:
    """Return the corners (V, 2) of the convex hull of a list of positions: Flatland's engine takes polygons as that."""
    hull = shapely.MultiPoint(points.positions()).convex_hull if points.items() else None
    if not isinstance(hull, shapely.Polygon):
        raise points.refused("three or more [x, y] (m) that are not in line")
    return np.asarray(hull.exterior.coords)[:-1]


def _moved(points: NDArray[np.float64], place: Pose) -> NDArray[np.float64]:
    cos, sin = math.cos(place.theta), math.sin(place.theta)
    x, y = points.T
    return np.stack((place.x + cos * x - sin * y, place.y + sin * x + cos * y), axis=1)
