"""DynaBARN worlds written as its own are: a Gazebo world each, and the source of a plugin for each obstacle."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree

from arena_core.files import write_text_whole
from arena_worlds.formats.animation import animation_source
from arena_worlds.generators.dynabarn import DynabarnWorlds, Mover, MovingField

HEIGHT = 1.0  # m, of cylinders and walls, as published
CMAKE = """cmake_minimum_required(VERSION 3.5)
project(dynabarn_plugins)
find_package(gazebo REQUIRED)
set(CMAKE_CXX_FLAGS "${{CMAKE_CXX_FLAGS}} ${{GAZEBO_CXX_FLAGS}}")
include_directories(${{GAZEBO_INCLUDE_DIRS}})
link_directories(${{GAZEBO_LIBRARY_DIRS}})
foreach(name {names})
  add_library(${{name}} SHARED ${{name}}.cc)
  set_target_properties(${{name}} PROPERTIES PREFIX "")
  target_link_libraries(${{name}} ${{GAZEBO_LIBRARIES}})
endforeach()
"""


def write_set(folder: Path, source: DynabarnWorlds) -> list[Path]:
    """Write worlds/world_N.world and plugins/NAME.cc with a CMakeLists.txt below ``folder``; return the two folders."""
    worlds, plugins = folder / "worlds", folder / "plugins"
    for name, field in zip(source.names, source.fields, strict=True):
        write_text_whole(worlds / f"{name}.world", world_text(field))
        for mover in field.movers:
            write_text_whole(plugins / f"{mover.name}.cc", animation_source(mover.name, mover.animation))
    names = " ".join(mover.name for field in source.fields for mover in field.movers)
    write_text_whole(plugins / "CMakeLists.txt", CMAKE.format(names=names))
    return [worlds, plugins]


def world_text(field: MovingField) -> str:
    """Return a Gazebo world: cylinders that plugins move, and static walls."""
    root = ElementTree.Element("sdf", version="1.6")
    world = ElementTree.SubElement(root, "world", name="default")
    for uri in ("model://ground_plane", "model://sun"):
        ElementTree.SubElement(ElementTree.SubElement(world, "include"), "uri").text = uri
    for mover in field.movers:
        _add_mover(world, mover)
    for number, (x, y, yaw, length, width) in enumerate(field.walls.boxes.tolist()):
        measures = {"size": f"{length:g} {width:g} {HEIGHT:g}"}
        _add_model(world, f"wall_{number}", f"{x:g} {y:g} {HEIGHT / 2:g} 0 0 {yaw:g}", "box", measures)
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, "unicode") + "\n"


def _add_mover(world: ElementTree.Element, mover: Mover) -> None:
    x, y = mover.animation.positions[0].tolist()
    measures = {"radius": f"{mover.radius:g}", "length": f"{HEIGHT:g}"}
    model = _add_model(world, mover.name, f"{x:g} {y:g} 0 0 0 0", "cylinder", measures)
    ElementTree.SubElement(model, "plugin", name=mover.name, filename=f"{mover.name}.so")


def _add_model(
    world: ElementTree.Element, name: str, pose: str, kind: str, measures: Mapping[str, str]
) -> ElementTree.Element:
    model = ElementTree.SubElement(world, "model", name=name)
    ElementTree.SubElement(model, "static").text = "1"
    ElementTree.SubElement(model, "pose").text = pose
    link = ElementTree.SubElement(model, "link", name="link")
    for shape in _add_shapes(link):
        geometry = ElementTree.SubElement(ElementTree.SubElement(shape, "geometry"), kind)
        for key, text in measures.items():
            ElementTree.SubElement(geometry, key).text = text
    return model


def _add_shapes(link: ElementTree.Element) -> Iterator[ElementTree.Element]:
    """Yield what can be hit and what is seen."""
    for use in ("collision", "visual"):
        yield ElementTree.SubElement(link, use, name=use)
