"""A problem written in the scenario format of today's arena-rosnav."""

from __future__ import annotations

import json
from pathlib import PurePosixPath
from typing import Any

from arena_core import PedestrianSpec
from arena_tasks.scenario_files.arena_tools_writer import obstacle_anchor
from arena_tasks.scenario_files.problem import Problem

PERSON = "actor1"  # the model of a person that arena-simulation-setup has


def arena_rosnav_text(problem: Problem, map_name: str, models: list[str]) -> str:
    """Return the JSON of a problem; ``models`` are the names of its obstacles' models, in their order."""
    static = [
        {"name": f"obstacle_{number}", "model": model, "pos": [*obstacle_anchor(obstacle).tolist(), 0.0]}
        for number, (model, obstacle) in enumerate(zip(models, problem.obstacles, strict=True))
    ]
    content = {
        "robots": [{"start": problem.start.array().tolist(), "goal": problem.goal.array().tolist()}],
        "obstacles": {
            "static": static,
            "dynamic": [_person_agent(person) for person in problem.pedestrians],
            "interactive": [],
        },
        "resets": problem.repeats,
        **({"map": map_name} if map_name else {}),
    }
    return json.dumps(content, indent=2, allow_nan=False) + "\n"


def world_name(map_path: str) -> str:
    """Return what arena-rosnav calls the world of a map: the folder of WORLD/map/map.yaml or WORLD/map.yaml."""
    folders = [
        part for part in PurePosixPath(map_path.replace("\\", "/")).parts[:-1] if part not in ("map", "..", ".", "/")
    ]
    return folders[-1] if folders else ""


def unsupported_parts(problem: Problem) -> list[str]:
    """Return what the format has no place for, that the problem has."""
    people = problem.pedestrians
    said = {
        "goal_radius": problem.goal_radius is not None,
        "time_limit": problem.time_limit is not None,
        "furniture": bool(problem.furniture),
        "doors": bool(problem.doors),
        "the radii of people": any(person.radius != people[0].radius for person in people),
    }
    return [name for name, is_so in said.items() if is_so]


def _person_agent(person: PedestrianSpec) -> dict[str, Any]:
    """Return a person's agent; what its behaviour does not say is left to the defaults of the reader."""
    behaviour = {"type": "adult", **person.behaviour}
    return {
        "name": str(person.id + 1),
        "model": PERSON,
        "pos": [*person.position_xy.tolist(), 0.0],
        "vmax": person.desired_speed,
        "waypoints": [[*waypoint, 0.0] for waypoint in person.waypoints_xy.tolist()],
        **behaviour,
        "waypoint_mode": int(behaviour.get("waypoint_mode", 0)),
    }
