"""A problem written in the scenario format of arena-tools, its obstacles as Flatland models beside it."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import shapely
import yaml
from numpy.typing import NDArray

from arena_core import Obstacle, PedestrianSpec, Scenario
from arena_tasks.scenario_files.pedsim_agent import READ_ELSEWHERE
from arena_tasks.scenario_files.problem import Problem

AGENT: dict[str, float | str] = {  # what a new agent of arena-tools has, where a person's behaviour does not say
    "type": "adult",
    "start_up_mode": "default",
    "wait_time": 0.0,
    "trigger_zone_radius": 0.0,
    "chatting_probability": 0.0,
    "tell_story_probability": 0.0,
    "group_talking_probability": 0.0,
    "talking_and_walking_probability": 0.0,
    "requesting_service_probability": 0.0,
    "requesting_guide_probability": 0.0,
    "requesting_follower_probability": 0.0,
    "max_talking_distance": 5.0,
    "max_servicing_radius": 5.0,
    "talking_base_time": 10.0,
    "tell_story_base_time": 0.0,
    "group_talking_base_time": 10.0,
    "talking_and_walking_base_time": 6.0,
    "receiving_service_base_time": 20.0,
    "requesting_service_base_time": 30.0,
    "force_factor_desired": 1.0,
    "force_factor_obstacle": 1.0,
    "force_factor_social": 5.0,
    "force_factor_robot": 0.0,
}
BODIES = {"forklift": "big_forklift.model.yaml", "vehicle": "big_forklift.model.yaml"}  # Flatland models by type
PERSON = "person_two_legged.model.yaml"
MOST_CORNERS = 8  # of a polygon in Flatland's engine


def arena_tools_text(problem: Problem | Scenario, map_path: str, models: list[str]) -> str:
    """Return the JSON of a problem; ``models`` are the paths of its obstacles' models, in their order."""
    content = {
        "pedsim_agents": [_person_agent(number, person) for number, person in enumerate(problem.pedestrians)],
        "static_obstacles": [
            {"name": str(number + 1), "model_path": path, "pos": obstacle_anchor(obstacle).tolist(), "angle": 0.0}
            for number, (path, obstacle) in enumerate(zip(models, problem.obstacles, strict=True))
        ],
        "robot_position": [problem.start.x, problem.start.y],
        "robot_goal": [problem.goal.x, problem.goal.y],
        "resets": problem.repeats if isinstance(problem, Problem) else 1,
        "map_path": map_path,
        "format": "arena-tools",
    }
    return json.dumps(content, indent=4, allow_nan=False) + "\n"


def unsupported_parts(problem: Problem | Scenario) -> list[str]:
    """Return what the format has no place for, that the problem has."""
    people = problem.pedestrians
    said = {
        "the start's heading": problem.start.theta != 0.0,
        "the goal's heading": problem.goal.theta != 0.0,
        "goal_radius": problem.goal_radius is not None,
        "time_limit": problem.time_limit is not None,
        "furniture": bool(problem.furniture if isinstance(problem, Problem) else problem.world.furniture),
        "doors": bool(problem.doors),
        "the radii of people": any(person.radius != people[0].radius for person in people),
        "where trigger zones lie (there they are around the person)": any(
            "trigger_zone_x" in person.behaviour for person in people
        ),
    }
    return [name for name, is_so in said.items() if is_so]


def flatland_model_text(obstacle: Obstacle) -> str:
    """Return the YAML of a Flatland model with an obstacle's shape."""
    middle = obstacle_anchor(obstacle)
    if obstacle.radius > 0.0:
        footprints = [{"type": "circle", "center": [0.0, 0.0], "radius": obstacle.radius}]
    else:
        footprints = [
            {"type": "polygon", "points": (part - middle).tolist()} for part in _convex_parts(obstacle.vertices_xy)
        ]
    body = {"name": "base", "type": "static", "color": [0.8, 0.2, 0.0, 1.0]}
    shapes = [{**footprint, "density": 1.0, "layers": ["all"], "collision": True} for footprint in footprints]
    return yaml.safe_dump({"bodies": [{**body, "footprints": shapes}]}, sort_keys=False, default_flow_style=None)


def _person_agent(number: int, person: PedestrianSpec) -> dict[str, Any]:
    """Return an agent; keys of a person's behaviour that arena-tools does not know
    come last, for it passes them over.
    """
    behaviour = {**AGENT, **person.behaviour}
    at_random = behaviour.pop("waypoint_mode", 0)
    return {
        "name": str(number + 1),
        "id": 0,
        "pos": person.position_xy.tolist(),
        "type": behaviour["type"],
        "yaml_file": BODIES.get(str(behaviour["type"]), PERSON),
        "number_of_peds": 1,
        "vmax": person.desired_speed,
        **{key: value for key, value in behaviour.items() if key in AGENT},
        "waypoints": person.waypoints_xy.tolist(),
        "waypoint_mode": int(at_random),
        **{key: value for key, value in behaviour.items() if key not in AGENT and key not in READ_ELSEWHERE},
    }


def obstacle_anchor(obstacle: Obstacle) -> NDArray[np.float64]:
    """Return where an obstacle stands: its disc's centre, or the middle of its corners in whole centimetres."""
    if obstacle.radius > 0.0:
        return np.asarray(obstacle.vertices_xy[0])
    return np.asarray(obstacle.vertices_xy.mean(axis=0).round(2))


def _convex_parts(vertices: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Return a simple polygon as polygons that Flatland's engine can have: itself, or triangles."""
    polygon = shapely.Polygon(vertices)
    if len(vertices) <= MOST_CORNERS and polygon.convex_hull.equals(polygon):
        return [vertices]
    return [np.asarray(part.exterior.coords)[:-1] for part in shapely.constrained_delaunay_triangles(polygon).geoms]
