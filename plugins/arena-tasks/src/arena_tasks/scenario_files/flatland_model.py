"""The shapes of a Flatland model, as static obstacles of arena-tools and
arena-rosnav name it by its file or its name.
"""

from __future__ import annotations

import math
from pathlib import Path, PurePosixPath
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from arena_core import Obstacle, Pose
from arena_core.files import is_file
from arena_tasks.scenario_files.json_fields import Field
from arena_tasks.scenario_files.published_models import published_models
from arena_tasks.scenario_files.yaml_fields import read_yaml

ENTITIES = "entities/obstacles/static"  # where arena-simulation-setup has them, seen from its own folder
# from the scenario's folder; the later ones are where arena-tools, arena-rosnav and arena-simulation-setup have them
FOLDERS = (".", "obstacles", "../obstacles", f"../../../{ENTITIES}", f"../../../../{ENTITIES}")
NAMES = (
    "{0}.model.yaml",
    "{0}.yaml",
    "{0}/{0}.model.yaml",
    "{0}/{0}.yaml",
    "{0}/yaml/{0}.yaml",
    "{0}/yaml/{0}.model.yaml",
)
SUFFIXES = (".model.yaml", ".yaml", ".yml")
ROS2 = "/**", "ros__parameters"  # what newer files wrap everything in

SOLID = "a shape with collision: false is solid here (in Flatland the lidar sees it and the robot drives through it)"
SENSOR = "a shape with sensor: true is left out (in Flatland no lidar sees it and nothing collides with it)"
NOWHERE = "a shape on no layer is left out (in Flatland nothing sees it or collides with it)"


class Shapes(NamedTuple):
    """What stands there, in ``map``, and in words what was not taken as it is written."""

    obstacles: tuple[Obstacle, ...]
    notes: tuple[str, ...]


def placed_model(stated: Field, place: Pose) -> Shapes:
    """Return the shapes of the model that a file names, at ``place``; a model that is nowhere is left out and noted.

    Of a path the file's name counts: it is sought as it stands, then by NAMES in FOLDERS, then among the published
    ones. Raises InputFileError for a file that is no Flatland model.
    """
    name = stated.text().replace("\\", "/").replace("\0", "")
    path = _model_file(stated.file.parent, name)
    model = (
        Field(stated.file, stated.key, published_models().get(_model_name(name)))
        if path is None
        else read_yaml(path, "a Flatland model")
    )
    if model.value is None and path is None:
        return Shapes((), (f"{_model_name(name)} is left out, for no model of that name was found",))
    return _join_shapes([_body_shapes(body, place) for body in _unwrap_model(model)["bodies"].items()])


def _model_file(folder: Path, name: str) -> Path | None:
    stem = _model_name(name)
    own = [PurePosixPath(name).name] if name.endswith(SUFFIXES) else []
    places = [Path(name)] if own else []
    places += [folder / place / pattern.format(stem) for place in FOLDERS for pattern in (*own, *NAMES) if stem]
    return next((place for place in places if is_file(place)), None)


def _model_name(name: str) -> str:
    """Return a model's name: a path's last part without its ending, and without what
    ``format`` would take for a place.
    """
    last = PurePosixPath(name).name
    ending = next((suffix for suffix in SUFFIXES if last.endswith(suffix)), "")
    return last[: len(last) - len(ending)]


def _unwrap_model(model: Field) -> Field:
    for name in ROS2:
        model = model[name] if model.has(name) else model
    return model


def _body_shapes(body: Field, place: Pose) -> Shapes:
    """Return the footprints of a body that a lidar sees.

    Flatland's rays end at every footprint of their layers that is no sensor, whether or not it collides
    (flatland_plugins, laser.cpp).
    """
    at = place.compose(body["pose"].pose()) if body.has("pose") else place
    return _join_shapes([_footprint_shapes(footprint, at) for footprint in body["footprints"].items()])


def _footprint_shapes(footprint: Field, at: Pose) -> Shapes:
    if _has_flag(footprint, "sensor", truth=True):
        return Shapes((), (SENSOR,))
    if footprint.has("layers") and footprint["layers"].value == []:
        return Shapes((), (NOWHERE,))
    return Shapes(
        (_footprint_obstacle(footprint, at),), (SOLID,) if _has_flag(footprint, "collision", truth=False) else ()
    )


def _has_flag(footprint: Field, key: str, *, truth: bool) -> bool:
    """Return whether a key is there with this truth; some files write it as a text."""
    return footprint.has(key) and str(footprint[key].value).lower() == str(truth).lower()


def _footprint_obstacle(footprint: Field, at: Pose) -> Obstacle:
    if footprint["type"].value == "circle":
        centre = footprint["center"].position() if footprint.has("center") else np.zeros(2)
        return Obstacle(_move_points(centre[None], at), footprint["radius"].number(above=0.0))
    if footprint["type"].value == "polygon":
        return Obstacle(_move_points(convex_hull(footprint["points"]), at))
    raise footprint["type"].rejection("circle or polygon")


def _join_shapes(parts: list[Shapes]) -> Shapes:
    return Shapes(
        tuple(shape for part in parts for shape in part.obstacles), tuple(note for part in parts for note in part.notes)
    )


def convex_hull(points: Field) -> NDArray[np.float64]:
    """Return the corners (V, 2) of the convex hull of a list of positions: Flatland's engine takes polygons as that."""
    hull = shapely.MultiPoint(points.positions()).convex_hull if points.items() else None
    if not isinstance(hull, shapely.Polygon):
        raise points.rejection("three or more [x, y] (m) that are not in line")
    return np.asarray(hull.exterior.coords)[:-1]


def _move_points(points: NDArray[np.float64], place: Pose) -> NDArray[np.float64]:
    cos, sin = math.cos(place.theta), math.sin(place.theta)
    x, y = points.T
    return np.stack((place.x + cos * x - sin * y, place.y + sin * x + cos * y), axis=1)
