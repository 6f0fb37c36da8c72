"""For authors of plugins: samples to test with, and the contract test of every kind of component."""

from arena_core.testing.checks import CHECKS, check
from arena_core.testing.command import CheckCommand
from arena_core.testing.samples import (
    component,
    free_costmap,
    observation,
    planner,
    record,
    robot,
    room,
    scan,
    scenario,
    sensors,
    straight_path,
)

__all__ = [
    "CHECKS",
    "CheckCommand",
    "check",
    "component",
    "free_costmap",
    "observation",
    "planner",
    "record",
    "robot",
    "room",
    "scan",
    "scenario",
    "sensors",
    "straight_path",
]
