"""The scenario format of arena-tools, as Arena-Bench's own scenarios are written."""

from __future__ import annotations

import numpy as np

from arena_core import Obstacle, PedestrianSpec, Pose
from arena_tasks.companions import MOST_COMPANIONS, numbered, with_companions
from arena_tasks.flatland import placed_shape
from arena_tasks.flatland_model import placed_model
from arena_tasks.json_fields import Field
from arena_tasks.problem import MOST_REPEATS, Keys, PersonDefaults, Problem

READ_ELSEWHERE = {"name", "id", "pos", "yaml_file", "number_of_peds", "vmax", "waypoints", "waypoint_mode"}
LOOP, AT_RANDOM = 0, 1  # waypoint_mode: in turn, or the next one drawn among the others


def is_arena_tools(root: Field) -> bool:
    """Tell whether a file has this format."""
    return root.has("pedsim_agents") or (root.has("format") and root["format"].value == "arena-tools")


def read_arena_tools(root: Field, defaults: PersonDefaults) -> Problem:
    """Read the one problem of a file; raise InputFileError. Its ``map_path`` belongs to another machine and is ignored."""
    if root.has("interactive_obstacles") and root["interactive_obstacles"].items():
        raise root["interactive_obstacles"].refused("an empty list, for nobody loads and unloads shelves here")
    crowd = [(agent.key, person) for agent in root["pedsim_agents"].items() for person in _people(agent, defaults)]
    obstacles = root["static_obstacles"].items() if root.has("static_obstacles") else []
    return Problem(
        name=root.file.stem,
        start=Pose(*root["robot_position"].position().tolist()),
        goal=Pose(*root["robot_goal"].position().tolist()),
        pedestrians=numbered(person for _, person in crowd),
        obstacles=tuple(shape for obstacle in obstacles for shape in _shapes(obstacle)),
        goal_radius=None,
        time_limit=None,
        keys=Keys("robot_position", "robot_goal", tuple(key for key, _ in crowd)),
        repeats=max(root["resets"].integer(0, MOST_REPEATS), 1) if root.has("resets") else 1,
    )


def _shapes(obstacle: Field) -> list[Obstacle]:
    """Return a static obstacle: of a Flatland model, or with its own shape as in the older format."""
    return [placed_shape(obstacle)] if obstacle.has("shape") else placed_model(obstacle)


def _people(agent: Field, defaults: PersonDefaults) -> list[PedestrianSpec]:
    """Return the people of one agent: ``number_of_peds`` of them, the first at ``pos``, the others close around it."""
    person = PedestrianSpec(
        id=0,
        position_xy=agent["pos"].position(),
        waypoints_xy=agent["waypoints"].positions() if agent.has("waypoints") else np.empty((0, 2)),
        max_speed=agent["vmax"].number(above=0.0) if agent.has("vmax") else defaults.speed,
        radius=defaults.radius,
        behaviour=_behaviour(agent),
    )
    return with_companions(person, agent["number_of_peds"].integer(1, MOST_COMPANIONS) if agent.has("number_of_peds") else 1)


def _behaviour(agent: Field) -> dict[str, float | str]:
    """Return the numbers and texts that only a pedestrian model can make something of; a round is a loop unless it is at random."""
    found: dict[str, float | str] = {}
    for name, field in agent.entries():
        if name not in READ_ELSEWHERE and isinstance(field.value, int | float | str) and not isinstance(field.value, bool):
            found[name] = field.value if isinstance(field.value, str) else field.number()
    if agent.has("waypoint_mode") and agent["waypoint_mode"].integer(LOOP, AT_RANDOM) == AT_RANDOM:
        found["waypoint_mode"] = float(AT_RANDOM)
    return found
