"""Every installed planner preset, on every installed robot, keeps the contract or says which robots it can drive."""

import re
from functools import cache
from pathlib import Path

import pytest

from arena_core import ConfigurationError
from arena_core.cli.listing import preset_files
from arena_core.hosting import load_registry
from arena_core.testing import check, component
from tests.conftest import of_the_suite

PAGE = Path(__file__).resolve().parents[1] / "docs" / "planners.md"
OUTSIDE = ("ros_external",)  # its commands come from another process: arena-ros has tests of its own
KINEMATICS = ("differential", "omnidirectional", "ackermann")


@cache
def body(name):
    return component("robot", name)


def cases():
    """Yield every pair of preset and robot."""
    registry = load_registry()
    for preset in sorted({*preset_files(registry, "planner")} - {*OUTSIDE}):
        for robot in preset_files(registry, "robot"):
            yield pytest.param(preset, robot, id=f"{preset}-{robot}")


@pytest.mark.parametrize(("preset", "robot"), list(cases()))
def test_preset_keeps_the_contract_or_names_what_it_can_drive(preset, robot):
    refusal = None
    try:
        planner = component("planner", preset, robot_preset=robot, robot=body(robot))
    except ConfigurationError as error:
        refusal = str(error)
    if refusal is None:
        assert check("planner", planner, body(robot))
    else:
        _, _, allowed = refusal.partition("allowed:")
        drivable = set(re.findall(r"\w+", allowed))
        assert drivable & {*KINEMATICS, *preset_files(load_registry(), "robot")}, refusal
        assert not drivable & {body(robot).kinematics, robot}, refusal


def test_every_planner_is_in_the_comparison():
    text = PAGE.read_text()
    assert [name for name in of_the_suite("planner") if f"`{name}`" not in text] == []


def test_no_shipped_network_tells_where_it_was_made():
    """Exporters write folders and lines of code into a file unless they are told not to."""
    networks = sorted(Path(__file__).parents[1].glob("plugins/*/src/*/policies*/*.onnx"))
    assert networks
    assert [str(path) for path in networks if b".py" in path.read_bytes()] == []
