"""Upright solids written as a Gazebo world (SDF 1.6): what Gazebo Classic and the newer Gazebo read."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree import ElementTree

from arena_core import Pose
from arena_core.scenes import Scene
from arena_worlds.formats.sdf import GROUND

SUN = {
    "cast_shadows": "1",
    "pose": "0 0 10 0 0 0",
    "diffuse": "0.8 0.8 0.8 1",
    "specular": "0.2 0.2 0.2 1",
    "direction": "-0.5 0.1 -0.9",
}
GROUND_COLOUR, WALL_COLOUR = "0.8 0.8 0.8 1", "0.45 0.5 0.6 1"


def sdf_text(scene: Scene, name: str) -> str:
    """Return the world file of a scene: one static model for all of them, one for the ground."""
    root = ElementTree.Element("sdf", version="1.6")
    world = ElementTree.SubElement(root, "world", name=name)
    _add_light(world)
    if scene.size is not None:
        _add_ground(_add_static_model(world, GROUND, scene.origin), *scene.size)
    walls = _add_static_model(world, "walls", scene.origin)
    for number, (x, y, yaw, length, width, bottom, top) in enumerate(scene.boxes.tolist()):
        _add_shape(
            walls,
            f"box_{number}",
            (x, y, 0.5 * (bottom + top), yaw),
            "box",
            {"size": (length, width, top - bottom)},
            WALL_COLOUR,
        )
    for number, (x, y, radius, bottom, top) in enumerate(scene.cylinders.tolist()):
        measures = {"radius": (radius,), "length": (top - bottom,)}
        _add_shape(walls, f"cylinder_{number}", (x, y, 0.5 * (bottom + top), 0.0), "cylinder", measures, WALL_COLOUR)
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, "unicode") + "\n"


def _add_light(world: ElementTree.Element) -> None:
    sun = ElementTree.SubElement(world, "light", type="directional", name="sun")
    for tag, text in SUN.items():
        ElementTree.SubElement(sun, tag).text = text


def _add_static_model(world: ElementTree.Element, name: str, place: Pose) -> ElementTree.Element:
    """Add a static model and return its link."""
    model = ElementTree.SubElement(world, "model", name=name)
    ElementTree.SubElement(model, "static").text = "1"
    ElementTree.SubElement(model, "pose").text = _pose_text(place.x, place.y, 0.0, place.theta)
    return ElementTree.SubElement(model, "link", name="link")


def _add_ground(link: ElementTree.Element, length: float, width: float) -> None:
    measures = {"normal": (0.0, 0.0, 1.0), "size": (length, width)}
    _add_shape(link, "ground", (0.5 * length, 0.5 * width, 0.0, 0.0), "plane", measures, GROUND_COLOUR)


def _add_shape(
    link: ElementTree.Element,
    name: str,
    place: tuple[float, float, float, float],
    kind: str,
    measures: Mapping[str, tuple[float, ...]],
    colour: str,
) -> None:
    """Add what can be hit and what is seen, both of the same shape."""
    for use in ("collision", "visual"):
        # newer versions of SDF want no two siblings of one name
        element = ElementTree.SubElement(link, use, name=f"{name}_{use}")
        ElementTree.SubElement(element, "pose").text = _pose_text(*place)
        shape = ElementTree.SubElement(ElementTree.SubElement(element, "geometry"), kind)
        for key, values in measures.items():
            ElementTree.SubElement(shape, key).text = " ".join(map(plain_number, values))
        if use == "visual":
            material = ElementTree.SubElement(element, "material")
            for key in ("ambient", "diffuse"):
                ElementTree.SubElement(material, key).text = colour


def _pose_text(x: float, y: float, z: float, yaw: float) -> str:
    return " ".join(map(plain_number, (x, y, z, 0.0, 0.0, yaw)))


def plain_number(value: float) -> str:
    """Return a number with as many digits as tell it from its neighbours, 12 at most."""
    return f"{value + 0.0:.12g}"  # adding nothing makes -0 plain
