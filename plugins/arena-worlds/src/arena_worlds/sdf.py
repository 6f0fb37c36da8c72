"""Upright static cylinders from a Gazebo world (SDF), plain or gzip."""

from __future__ import annotations

import gzip
import math
import zlib
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from xml.parsers import expat

from arena_core import InputFileError, Pose

LARGEST_FILE = 20_000_000  # bytes, unpacked; BARN's worlds have 0.5 million
FARTHEST = 1e4  # m
UPRIGHT = 1e-6  # rad


@dataclass(frozen=True, slots=True)
class Cylinder:
    """An upright cylinder as a disc at (``x``, ``y``), m."""

    x: float
    y: float
    radius: float


def read_cylinders(path: Path) -> list[Cylinder]:
    """Read the cylinders of a Gazebo world; raise InputFileError with file, element and what is allowed.

    Models have to stand still; ground planes are left out, any other collision shape is refused. Poses under ``state`` are not read.
    """
    root = parse_xml(path, unpacked(path))
    worlds = root.findall("world") if root.tag == "sdf" else []
    if len(worlds) != 1:
        raise InputFileError(f"{path}: holds {len(worlds)} elements sdf/world; allowed: a Gazebo world file, with exactly one")
    if worlds[0].find("include") is not None:
        raise InputFileError(f"{path}: world/include is there; allowed: models written out in the file")
    found = [cylinder for model in worlds[0].findall("model") for cylinder in _cylinders(path, model)]
    if not found:
        raise InputFileError(f"{path}: holds no cylinder; allowed: a world with at least one static cylinder")
    return found


def unpacked(path: Path) -> bytes:
    """Return a file's content, unpacked if its name ends in .gz; raise InputFileError if it cannot be read or is too large."""
    try:
        with gzip.open(path) if path.suffix == ".gz" else path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise InputFileError(f"{path}: is no gzip file ({error}); allowed: a whole .world.gz file") from None
    except OSError as error:
        raise InputFileError(f"{path}: cannot be read ({error.strerror}); allowed: a .world or .world.gz file") from None
    if len(content) > LARGEST_FILE:
        raise InputFileError(f"{path}: is larger than {LARGEST_FILE} bytes unpacked; allowed: up to that")
    return content


def parse_xml(path: Path, content: bytes) -> ElementTree.Element:
    """Parse XML without document types, and so without entities of its own or from outside; raise InputFileError."""
    builder, parser = ElementTree.TreeBuilder(), expat.ParserCreate()
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.data

    def refuse(*_: object) -> None:
        raise InputFileError(f"{path}: line {parser.CurrentLineNumber}: has a document type; allowed: XML without <!DOCTYPE ...>")

    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise InputFileError(f"{path}: is no XML ({error}); allowed: a Gazebo world file") from None
    return builder.close()


def _cylinders(path: Path, model: ElementTree.Element) -> list[Cylinder]:
    name = f"model {model.get('name', '')!r}"
    place, found = _pose(path, name, model), []
    for link in model.findall("link"):
        link_place = place.compose(_pose(path, name, link))
        for collision in link.findall("collision"):
            radius = _radius(path, name, collision)
            if radius is not None:
                centre = link_place.compose(_pose(path, name, collision))
                found.append(Cylinder(centre.x, centre.y, radius))
    if found and (model.findtext("static") or "").strip().lower() not in ("1", "true"):
        raise InputFileError(f"{path}: {name}: static is {model.findtext('static')!r}; allowed: 1 (what moves is not read)")
    return found


def _radius(path: Path, name: str, collision: ElementTree.Element) -> float | None:
    """Return a cylinder's radius, m; None for a ground plane."""
    shapes = [shape.tag for shape in collision.findall("geometry/*")]
    if shapes == ["plane"]:
        return None
    if shapes != ["cylinder"]:
        raise InputFileError(f"{path}: {name}: geometry is {', '.join(shapes) or 'missing'}; allowed: cylinder (and plane, the ground)")
    text = collision.findtext("geometry/cylinder/radius") or ""
    radius = _number(text)
    if radius is None or not 0.0 < radius <= FARTHEST:
        raise InputFileError(f"{path}: {name}: radius is {text.strip()!r}; allowed: > 0 (m)")
    return radius


def _pose(path: Path, name: str, element: ElementTree.Element) -> Pose:
    """Return x, y and yaw of an element's ``pose``, the origin where it has none."""
    text = element.findtext("pose")
    if text is None:
        return Pose(0.0, 0.0)
    numbers = [number for number in map(_number, text.split()) if number is not None]
    if len(numbers) != 6 or len(text.split()) != 6 or max(map(abs, numbers)) > FARTHEST:
        raise InputFileError(f"{path}: {name}: pose is {' '.join(text.split())[:60]!r}; allowed: six numbers x y z roll pitch yaw (m, rad)")
    x, y, _, roll, pitch, yaw = numbers
    if max(abs(roll), abs(pitch)) > UPRIGHT:
        raise InputFileError(f"{path}: {name}: pose has roll {roll:g} and pitch {pitch:g}; allowed: 0, upright")
    return Pose(x, y, yaw)


def _number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None
