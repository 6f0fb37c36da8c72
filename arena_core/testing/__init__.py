"""For authors of plugins: samples to test with, and the contract test of every kind of component."""

from arena_core.testing.checks import CHECKS, check
from arena_core.testing.samples import (
    component,
    free_costmap,
    furniture,
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
from arena_core.testing.steps import join_batches, transition
from arena_core.testing.views import boxes_costmap, tracked, view

__all__ = [
    "CHECKS",
    "boxes_costmap",
    "check",
    "component",
    "free_costmap",
    "furniture",
    "join_batches",
    "observation",
    "planner",
    "record",
    "robot",
    "room",
    "scan",
    "scenario",
    "sensors",
    "straight_path",
    "tracked",
    "transition",
    "view",
]
