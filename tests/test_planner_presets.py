"""Every installed planner preset is made for every robot, or says which it can drive; `arena check all` tries them."""

import re
from functools import cache
from pathlib import Path

import pytest

from arena_core import ConfigurationError, Planner
from arena_core.cli.listing import preset_files
from arena_core.hosting import load_registry
from arena_core.testing import component
from tests.conftest import of_the_suite

PAGE = Path(__file__).resolve().parents[1] / "docs" / "planners.md"
OUTSIDE = ("ros_external",)  # its commands come from another process: arena-ros has tests of its own
KINEMATICS = ("differential", "omnidirectional", "ackermann")


@cache
def body(name):
    return component("robot", name)


@pytest.mark.parametrize("preset", sorted({*preset_files(load_registry(), "planner")} - {*OUTSIDE}))
def test_preset_is_made_for_every_robot_or_names_what_it_can_drive(preset):
    made = [made_for(robot, preset) for robot in preset_files(load_registry(), "robot")]
    assert any(isinstance(planner, Planner) for planner in made)


def made_for(robot, preset):
    """Make a planner for a robot, or None; the refusal then names other drives or robots."""
    try:
        return component("planner", preset, robot_preset=robot, robot=body(robot))
    except ConfigurationError as error:
        refusal = str(error)
    drivable = set(re.findall(r"\w+", refusal.partition("allowed:")[2]))
    assert drivable & {*KINEMATICS, *preset_files(load_registry(), "robot")}, refusal
    assert not drivable & {body(robot).kinematics, robot}, refusal
    return None


def test_every_planner_is_in_the_comparison():
    text = PAGE.read_text()
    assert [name for name in of_the_suite("planner") if f"`{name}`" not in text] == []


def test_no_shipped_network_tells_where_it_was_made():
    """Exporters write folders and lines of code into a file unless they are told not to."""
    networks = sorted(Path(__file__).parents[1].glob("plugins/*/src/*/policies*/*.onnx"))
    assert networks
    assert [str(path) for path in networks if b".py" in path.read_bytes()] == []
