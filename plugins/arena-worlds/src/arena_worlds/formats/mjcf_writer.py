"""Upright solids written as a MuJoCo model (MJCF)."""

from __future__ import annotations

from xml.etree import ElementTree

from arena_core.scenes import Scene
from arena_worlds.formats.mjcf import MAP_BODY
from arena_worlds.formats.sdf_writer import plain_number

GROUND_COLOUR, WALL_COLOUR = "0.8 0.8 0.8 1", "0.45 0.5 0.6 1"
# height of the camera above the map by its longer side: all of it is within the 45 degrees of MuJoCo's cameras
VIEW = 1.25


def mjcf_text(scene: Scene, name: str) -> str:
    """Return the model of a scene: one body without joints, the ground its first geom, a camera ``top`` above."""
    root = ElementTree.Element("mujoco", model=name)
    ElementTree.SubElement(root, "compiler", angle="radian")
    world = ElementTree.SubElement(root, "worldbody")
    ElementTree.SubElement(world, "light", directional="true", pos="0 0 10", dir="-0.5 0.1 -0.9", castshadow="false")
    place = scene.origin
    turn = _join_numbers(0.0, 0.0, place.theta)
    body = ElementTree.SubElement(world, "body", name=MAP_BODY, pos=_join_numbers(place.x, place.y, 0.0), euler=turn)
    _add_ground(body, scene)
    for number, (x, y, yaw, length, width, bottom, top) in enumerate(scene.boxes.tolist()):
        size, middle = (
            _join_numbers(0.5 * length, 0.5 * width, 0.5 * (top - bottom)),
            _join_numbers(x, y, 0.5 * (bottom + top)),
        )
        _add_geom(body, f"box_{number}", "box", size, WALL_COLOUR, pos=middle, euler=_join_numbers(0.0, 0.0, yaw))
    for number, (x, y, radius, bottom, top) in enumerate(scene.cylinders.tolist()):
        size, middle = _join_numbers(radius, 0.5 * (top - bottom)), _join_numbers(x, y, 0.5 * (bottom + top))
        _add_geom(body, f"cylinder_{number}", "cylinder", size, WALL_COLOUR, pos=middle)
    ElementTree.indent(root)
    return ElementTree.tostring(root, "unicode") + "\n"


def _add_ground(body: ElementTree.Element, scene: Scene) -> None:
    """Add the ground, without end (0) where it is not bounded, and a camera that sees all of it."""
    if scene.size is None:
        _add_geom(body, "ground", "plane", _join_numbers(0.0, 0.0, 1.0), GROUND_COLOUR)
        return
    length, width = scene.size
    middle = (0.5 * length, 0.5 * width)
    height = float(max(scene.boxes[:, -1].max(initial=0.0), scene.cylinders[:, -1].max(initial=0.0)))
    _add_geom(body, "ground", "plane", _join_numbers(*middle, 1.0), GROUND_COLOUR, pos=_join_numbers(*middle, 0.0))
    ElementTree.SubElement(body, "camera", name="top", pos=_join_numbers(*middle, height + VIEW * max(length, width)))


def _add_geom(body: ElementTree.Element, name: str, kind: str, size: str, colour: str, **place: str) -> None:
    ElementTree.SubElement(body, "geom", {"name": name, "type": kind, "size": size, **place, "rgba": colour})


def _join_numbers(*values: float) -> str:
    return " ".join(map(plain_number, values))
