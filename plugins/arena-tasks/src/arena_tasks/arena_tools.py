"""The scenario format of arena-tools, as Arena-Bench's own scenarios are written."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_core import PedestrianSpec, Pose
from arena_tasks.json_fields import Field
from arena_tasks.problem import Keys, PersonDefaults, Problem

READ_ELSEWHERE = {"name", "id", "pos", "yaml_file", "number_of_peds", "vmax", "waypoints", "waypoint_mode"}
LARGEST_GROUP = 10_000
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


def is_arena_tools(root: Field) -> bool:
    """Tell whether a file has this format."""
    return root.has("pedsim_agents") or (root.has("format") and root["format"].value == "arena-tools")


def read_arena_tools(root: Field, defaults: PersonDefaults) -> Problem:
    """Read the one problem of a file; its ``map_path`` belongs to another machine, and ``resets`` to another program: both are ignored."""
    for name in ("static_obstacles", "interactive_obstacles"):
        if root.has(name) and root[name].items():
            raise root[name].refused(
                "an empty list, because their shapes are not in this file; write them as obstacles of docs/scenarios.md"
            )
    agents = root["pedsim_agents"].items()
    crowd = [(agent.key, person) for agent in agents for person in _people(agent, defaults)]
    return Problem(
        name=root.file.stem,
        start=Pose(*root["robot_position"].position().tolist()),
        goal=Pose(*root["robot_goal"].position().tolist()),
        pedestrians=tuple(_numbered(number, person) for number, (_, person) in enumerate(crowd)),
        obstacles=(),
        goal_radius=None,
        time_limit=None,
        keys=Keys("robot_position", "robot_goal", tuple(key for key, _ in crowd)),
    )


def _people(agent: Field, defaults: PersonDefaults) -> list[PedestrianSpec]:
    """Return the people of one agent: ``number_of_peds`` of them, the first at ``pos``, the others close around it."""
    if agent.has("waypoint_mode") and agent["waypoint_mode"].value != 0:
        raise agent["waypoint_mode"].refused("0 (in a loop)")
    count = agent["number_of_peds"].integer(1, LARGEST_GROUP) if agent.has("number_of_peds") else 1
    speed = agent["vmax"].number(above=0.0) if agent.has("vmax") else defaults.speed
    position = agent["pos"].position()
    waypoints = agent["waypoints"].positions() if agent.has("waypoints") else np.empty((0, 2))
    behaviour = {name: field.value for name, field in agent.entries() if name not in READ_ELSEWHERE and _is_plain(field.value)}
    return [
        PedestrianSpec(0, position + _beside(k, defaults.radius), waypoints, speed, defaults.radius, dict(behaviour)) for k in range(count)
    ]


def _is_plain(value: object) -> bool:
    return isinstance(value, int | float | str) and not isinstance(value, bool)


def _beside(number: int, radius: float) -> NDArray[np.float64]:
    """Return where the ``number``-th of a group stands around the first: on a sunflower's spiral, in which discs do not touch."""
    angle = number * GOLDEN_ANGLE
    return 2.2 * radius * math.sqrt(number) * np.array((math.cos(angle), math.sin(angle)))


def _numbered(number: int, person: PedestrianSpec) -> PedestrianSpec:
    return PedestrianSpec(number, person.position_xy, person.waypoints_xy, person.max_speed, person.radius, person.behaviour)
