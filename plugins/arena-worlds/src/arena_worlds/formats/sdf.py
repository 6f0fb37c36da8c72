"""A Gazebo world (SDF) read as upright static solids."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import unquote
from xml.etree import ElementTree

from arena_core import InputFileError, Pose
from arena_worlds.formats.sdf_state import State, state_of
from arena_worlds.formats.solids import UPRIGHT, Shape, Solids, solids_from
from arena_worlds.formats.xml_file import parse_numbers, quote_text, read_xml

ALLOWED = "a Gazebo world file (.sdf, .world or .world.gz)"
GROUND = "map_ground"  # the model whose plane bounds the map; any other plane is a ground without end
POSE_ATTRIBUTES: dict[str, tuple[str, ...]] = {  # SDF 1.9
    "relative_to": (),
    "frame": (),
    "degrees": ("true", "false", "1", "0"),
    "rotation_format": ("euler_rpy", "quat_xyzw"),
}
# Includes that no one can bump into: of Gazebo Classic, and of Fuel with or without a version
HARMLESS = re.compile(
    r"(model:/|https?://[\w.]+/([\d.]+/)?openrobotics/(fuel/)?models)/(sun|ground[_ ]plane)(/(\d+|tip))?/?",
    re.IGNORECASE,
)


def read_sdf(path: Path) -> Solids:
    """Read the boxes and cylinders of a Gazebo world; raise InputFileError with file, element and what is allowed.

    Models have to stand still; any other collision shape is refused but for planes, the ground. Heights are not read.
    Where a file has a ``state``, models and links stand where it says.
    """
    root = read_xml(path, ALLOWED)
    return solids_of_models(path, models_of(path, root), state_of(path, root))


def models_of(path: Path, root: ElementTree.Element) -> list[ElementTree.Element]:
    """Return the models of a file's one world; raise InputFileError where it has another number of them, or
    includes what could be hit.
    """
    worlds = root.findall("world") if root.tag == "sdf" else []
    if len(worlds) != 1:
        raise InputFileError(
            f"{path}: holds {len(worlds)} elements sdf/world; allowed: a Gazebo world file, with exactly one"
        )
    _check_includes(path, worlds[0])
    return worlds[0].findall("model")


def _check_includes(path: Path, parent: ElementTree.Element) -> None:
    for include in parent.findall("include"):
        uri = (include.findtext("uri") or "").strip()
        if not HARMLESS.fullmatch(unquote(uri)):
            name = parent.get("name", "")
            raise InputFileError(
                f"{path}: {parent.tag} {quote_text(name)}: include is {quote_text(uri)}; allowed: "
                "models written out in the file"
            )
    for other in parent.findall("population"):
        raise InputFileError(
            f"{path}: population {quote_text(other.get('name', ''))} is there; allowed: models written out in the file"
        )


def solids_of_models(path: Path, models: Sequence[ElementTree.Element], state: State) -> Solids:
    """Return what of models can be hit, where ``state`` has them; raise InputFileError as ``read_sdf`` does."""
    shapes = [shape for model in models for shape in _model_shapes(path, model, Pose(0.0, 0.0), state, static=False)]
    if not shapes:
        raise InputFileError(f"{path}: holds no cylinder and no box; allowed: a world with at least one, and static")
    return solids_from(shapes)


def _model_shapes(
    path: Path, model: ElementTree.Element, parent: Pose, state: State, *, static: bool
) -> Iterator[Shape]:
    name = model.get("name", "")
    _check_includes(path, model)
    now = state.models.get(name, State())
    place = (
        parent.compose(_element_pose(path, name, model))
        if now.element is None
        else _element_pose(path, name, now.element)
    )
    static = static or (model.findtext("static") or "").strip().lower() in ("1", "true")
    for link in model.findall("link"):
        moved = now.links.get(link.get("name", ""))
        link_place = (
            place.compose(_element_pose(path, name, link)) if moved is None else _element_pose(path, name, moved)
        )
        for collision in link.findall("collision"):
            shape = _collision_shape(path, name, collision, link_place.compose(_element_pose(path, name, collision)))
            if shape is None:
                continue
            if not static:
                said = model.findtext("static")
                raise InputFileError(f"{path}: model {name!r}: static is {said!r}; allowed: 1 (what moves is not read)")
            yield shape
    for nested in model.findall("model"):
        yield from _model_shapes(path, nested, place, now, static=static)


def _collision_shape(path: Path, name: str, collision: ElementTree.Element, place: Pose) -> Shape | None:
    """Return a collision's shape, None for a ground plane without end."""
    kinds = [shape.tag for shape in collision.findall("geometry/*")]
    match kinds:
        case ["cylinder"]:
            return Shape("cylinder", place, tuple(read_lengths(path, name, collision, "cylinder/radius", 1)))
        case ["box"]:
            return Shape("box", place, tuple(read_lengths(path, name, collision, "box/size", 3)[:2]))
        case ["plane"]:
            return (
                Shape("ground", place, tuple(read_lengths(path, name, collision, "plane/size", 2)))
                if name == GROUND
                else None
            )
    raise InputFileError(
        f"{path}: model {name!r}: geometry is {', '.join(kinds) or 'missing'}; allowed: "
        "box, cylinder (and plane, the ground)"
    )


def read_lengths(path: Path, name: str, collision: ElementTree.Element, key: str, count: int) -> list[float]:
    """Return so many lengths of a model's collision shape, m; raise InputFileError where there are others."""
    text = collision.findtext(f"geometry/{key}") or ""
    found = parse_numbers(text)
    if found is None or len(found) != count or min(found) <= 0.0:
        wanted = "a number > 0" if count == 1 else f"{count} numbers > 0"
        raise InputFileError(
            f"{path}: model {name!r}: {key.split('/')[1]} is {quote_text(text)}; allowed: {wanted} (m)"
        )
    return found


def _element_pose(path: Path, name: str, element: ElementTree.Element) -> Pose:
    """Return x, y and yaw of an element's ``pose``, the origin where it has none."""
    pose = element.find("pose")
    if pose is None:
        return Pose(0.0, 0.0)
    for attribute, allowed in POSE_ATTRIBUTES.items():
        if pose.get(attribute, "") not in ("", *allowed):
            said = " or ".join(allowed) or "none"
            raise InputFileError(
                f"{path}: model {name!r}: pose has {attribute} {quote_text(pose.get(attribute, ''))}; allowed: {said}"
            )
    text, by_quaternion = pose.text or "", pose.get("rotation_format") == "quat_xyzw"
    found = parse_numbers(text)
    if found is None or len(found) != (7 if by_quaternion else 6) or (by_quaternion and not any(found[3:])):
        form = "seven numbers x y z qx qy qz qw (m)" if by_quaternion else "six numbers x y z roll pitch yaw (m, rad)"
        raise InputFileError(f"{path}: model {name!r}: pose is {quote_text(text)}; allowed: {form}")
    unit = math.pi / 180.0 if pose.get("degrees") in ("true", "1") else 1.0
    roll, pitch, yaw = _roll_pitch_yaw(*found[3:]) if by_quaternion else (unit * angle for angle in found[3:])
    if max(abs(roll), abs(pitch)) > UPRIGHT:
        raise InputFileError(f"{path}: model {name!r}: pose has roll {roll:g} and pitch {pitch:g}; allowed: 0, upright")
    return Pose(found[0], found[1], yaw)


def _roll_pitch_yaw(i: float, j: float, k: float, w: float) -> tuple[float, float, float]:
    """Return roll, pitch and yaw of a quaternion of any length but 0, rad."""
    length = math.sqrt(i * i + j * j + k * k + w * w)
    i, j, k, w = i / length, j / length, k / length, w / length
    pitch = math.asin(min(1.0, max(-1.0, 2.0 * (w * j - k * i))))
    return (
        math.atan2(2.0 * (w * i + j * k), 1.0 - 2.0 * (i * i + j * j)),
        pitch,
        math.atan2(2.0 * (w * k + i * j), 1.0 - 2.0 * (j * j + k * k)),
    )
