"""A MuJoCo model (MJCF) read as upright static solids."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

from arena_core import InputFileError, Pose
from arena_worlds.formats.solids import UPRIGHT, Shape, Solids, solids_from
from arena_worlds.formats.xml_file import parse_numbers, quote_text, read_xml

ALLOWED = "a MuJoCo model (.xml)"
MAP_BODY = "map"  # the body whose plane bounds the map; any other plane is a ground without end
MOVING = ("joint", "freejoint")
# they would change what stands where
NOT_READ = ("include", "default", "frame", "replicate", "composite", "flexcomp", "attach")
NOT_READ_OF_GEOM = ("class", "axisangle", "xyaxes", "zaxis", "fromto", "mesh", "hfield")
SIZES = {"box": 3, "cylinder": 2, "plane": 3}  # how many numbers of its size are needed


def read_mjcf(path: Path) -> Solids:
    """Read the boxes and cylinders of a MuJoCo model; raise InputFileError with file, element and what is allowed.

    Bodies have to stand still; geoms that nothing collides with are left out, and so are planes, the ground. Heights
    are not read.
    """
    root = read_xml(path, ALLOWED)
    worlds = root.findall("worldbody") if root.tag == "mujoco" else []
    if len(worlds) != 1:
        raise InputFileError(
            f"{path}: holds {len(worlds)} elements mujoco/worldbody; allowed: a MuJoCo model, with exactly one"
        )
    for element in root.iter():
        if element.tag in NOT_READ:
            raise InputFileError(f"{path}: element {element.tag} is there; allowed: a model written out in the file")
    shapes = list(_body_shapes(path, worlds[0], Pose(0.0, 0.0), _angle_unit(path, root), moving=False))
    if not shapes:
        raise InputFileError(f"{path}: holds no cylinder and no box; allowed: a model with at least one, and static")
    return solids_from(shapes)


def _angle_unit(path: Path, root: ElementTree.Element) -> float:
    """Return what the file's unit of angles is in rad; degrees unless it says so."""
    unit = 1.0
    angle = "degree"
    for compiler in root.findall("compiler"):
        angle = compiler.get("angle", angle)
        if compiler.get("eulerseq", "xyz") != "xyz":
            raise InputFileError(
                f"{path}: compiler: eulerseq is {quote_text(compiler.get('eulerseq', ''))}; allowed: xyz"
            )
    if angle == "degree":
        unit = math.pi / 180.0
    elif angle != "radian":
        raise InputFileError(f"{path}: compiler: angle is {quote_text(angle)}; allowed: degree or radian")
    return unit


def _body_shapes(path: Path, body: ElementTree.Element, place: Pose, unit: float, *, moving: bool) -> Iterator[Shape]:
    moving = moving or any(body.find(tag) is not None for tag in MOVING)
    for geom in body.findall("geom"):
        if geom.get("contype") == "0" and geom.get("conaffinity") == "0":
            continue
        shape = _geom_shape(path, body, geom, place, unit)
        if shape is None:
            continue
        if moving:
            raise InputFileError(
                f"{path}: {_element_name(geom)}: its body has joints; allowed: bodies without (what moves is not read)"
            )
        yield shape
    for child in body.findall("body"):
        yield from _body_shapes(path, child, place.compose(_element_pose(path, child, unit)), unit, moving=moving)


def _geom_shape(
    path: Path, body: ElementTree.Element, geom: ElementTree.Element, parent: Pose, unit: float
) -> Shape | None:
    """Return a geom's shape, None for a ground plane without end."""
    kind = geom.get("type", "sphere")
    if kind not in SIZES:
        raise InputFileError(
            f"{path}: {_element_name(geom)}: type is {quote_text(kind)}; allowed: box, cylinder (and plane, the ground)"
        )
    for attribute in NOT_READ_OF_GEOM:
        if attribute in geom.attrib:
            raise InputFileError(
                f"{path}: {_element_name(geom)}: {attribute} is there; allowed: type, size, pos, euler, quat"
            )
    size = _read_numbers(path, geom, "size", SIZES[kind])
    if kind == "plane" and (body.get("name") != MAP_BODY or min(size[:2]) == 0.0):
        return None
    if min(size[:2]) <= 0.0:
        raise InputFileError(
            f"{path}: {_element_name(geom)}: size is {quote_text(geom.get('size', ''))}; allowed: numbers > 0 (m)"
        )
    place = parent.compose(_element_pose(path, geom, unit))
    if kind == "cylinder":
        return Shape("cylinder", place, (size[0],))
    return Shape("ground" if kind == "plane" else "box", place, (2.0 * size[0], 2.0 * size[1]))


def _element_pose(path: Path, element: ElementTree.Element, unit: float) -> Pose:
    """Return x, y and yaw of a body or geom."""
    x, y, _ = _read_numbers(path, element, "pos", 3, "0 0 0")
    if "quat" in element.attrib:
        w, i, j, k = _read_numbers(path, element, "quat", 4)
        roll, pitch, yaw = 2.0 * i, 2.0 * j, 2.0 * math.atan2(k, w)
    else:
        roll, pitch, yaw = (unit * angle for angle in _read_numbers(path, element, "euler", 3, "0 0 0"))
    if max(abs(roll), abs(pitch)) > UPRIGHT:
        raise InputFileError(
            f"{path}: {_element_name(element)}: it is tilted; allowed: turned about the vertical alone"
        )
    return Pose(x, y, yaw)


def _read_numbers(
    path: Path, element: ElementTree.Element, attribute: str, count: int, default: str = ""
) -> list[float]:
    text = element.get(attribute, default)
    found = parse_numbers(text)
    if found is None or len(found) != count:
        raise InputFileError(
            f"{path}: {_element_name(element)}: {attribute} is {quote_text(text)}; allowed: {count} numbers"
        )
    return found


def _element_name(element: ElementTree.Element) -> str:
    return f"{element.tag} {element.get('name', '')!r}"
