"""For authors of plugins: samples to test with, and the contract test of every kind of component."""

from arena_core.testing.checks import CHECKS, check
from arena_core.testing.samples import (
    component,
    free_costmap,
    furniture,
    observation,
    people,
    planner,
    record,
    robot,
    room,
    scan,
    scenario,
    sensors,
    straight_path,
    truth,
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
    "people",
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
    "truth",
    "view",
]
