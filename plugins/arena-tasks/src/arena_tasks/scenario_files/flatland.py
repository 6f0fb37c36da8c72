"""The older scenario format of arena-rosnav, for Flatland: scenes with static obstacles, moving discs and watchers."""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from arena_core import Obstacle, PedestrianSpec
from arena_tasks.scenario_files.companions import MOST_COMPANIONS, number_people, with_companions
from arena_tasks.scenario_files.flatland_model import convex_hull
from arena_tasks.scenario_files.json_fields import Field
from arena_tasks.scenario_files.problem import MOST_REPEATS, Keys, PersonDefaults, Problem

TITLES = ("scenarios", "scenerios")  # the second is how arena-rosnav's own example was written
MODES = ("yoyo", "loop", "once")
MOST_WATCHERS = 8  # that a person may wait for; the number of zones that a person of pedestrians=social_force has
BEHAVIOUR = {  # what a moving obstacle's keys are called in a person's behaviour
    "chatting_probability": "chatting_probability",
    "obstacle_force_factor": "force_factor_obstacle",
    "desire_force_factor": "force_factor_desired",
}


def is_flatland(root: Field) -> bool:
    """Return whether a file has this format: a list of scenes, the first with a scene_name or a robot."""
    scenes = next((root[title].value for title in TITLES if root.has(title)), None)
    first = scenes[0] if isinstance(scenes, list) and scenes else None
    return isinstance(first, dict) and ("scene_name" in first or "robot" in first)


def read_flatland(root: Field, defaults: PersonDefaults) -> tuple[Problem, ...]:
    """Read the scenes of a file; raise InputFileError.

    Those with ``repeats`` below 1 are left out: so their author switched them off.
    """
    scenes = root[next(title for title in TITLES if root.has(title))]
    problems: list[Problem] = []
    names = Counter[str]()
    for scene in scenes.items():
        repeats = scene["repeats"].read_integer(-MOST_REPEATS, MOST_REPEATS) if scene.has("repeats") else 1
        if repeats > 0:
            name = scene["scene_name"].text()
            names[name] += 1
            problems.append(
                _scene_problem(scene, name if names[name] == 1 else f"{name}-{names[name]}", repeats, defaults)
            )
    if not problems:
        raise scenes.rejection("at least one scene with repeats above 0")
    return tuple(problems)


def _scene_problem(scene: Field, name: str, repeats: int, defaults: PersonDefaults) -> Problem:
    robot = scene["robot"]
    discs = _member_values(scene, "dynamic_obstacles")
    crowd = [(disc.key, person) for disc in discs for person in _disc_people(disc, scene, defaults)]
    return Problem(
        name=name,
        start=robot["start_pos"].pose(),
        goal=robot["goal_pos"].pose(),
        pedestrians=number_people(person for _, person in crowd),
        obstacles=tuple(placed_shape(shape) for shape in _member_values(scene, "static_obstacles")),
        goal_radius=None,
        time_limit=None,
        keys=Keys(robot["start_pos"].key, robot["goal_pos"].key, tuple(key for key, _ in crowd)),
        repeats=repeats,
        notes=tuple(note for disc in discs for note in _disc_notes(disc)),
    )


def _member_values(scene: Field, name: str) -> list[Field]:
    """Return the values of a mapping or list, none where there is neither."""
    if not scene.has(name):
        return []
    return (
        scene[name].items() if isinstance(scene[name].value, list) else [member for _, member in scene[name].entries()]
    )


def placed_shape(shape: Field) -> Obstacle:
    """Return a static obstacle: a circle at x, y, or the convex hull of vertices, both in ``map``."""
    if shape["shape"].value == "circle":
        return Obstacle(
            np.array([[shape["x"].read_coordinate(), shape["y"].read_coordinate()]]), shape["radius"].number(above=0.0)
        )
    if shape["shape"].value == "polygon":
        return Obstacle(convex_hull(shape["vertices"]))
    raise shape["shape"].rejection("circle or polygon")


def _disc_people(disc: Field, scene: Field, defaults: PersonDefaults) -> list[PedestrianSpec]:
    """Return the people that a moving obstacle stands for; one that has no speed stands."""
    start = disc["start_pos"].pose()
    position = np.array((start.x, start.y))
    speed = disc["linear_velocity"].number(low=0.0) if disc.has("linear_velocity") else defaults.speed
    person = PedestrianSpec(
        id=0,
        position_xy=position,
        waypoints_xy=_patrol_waypoints(disc, position) if speed > 0.0 else np.empty((0, 2)),
        desired_speed=speed or defaults.speed,
        radius=disc["obstacle_radius"].number(above=0.0) if disc.has("obstacle_radius") else defaults.radius,
        behaviour={
            **{ours: disc[theirs].number() for theirs, ours in BEHAVIOUR.items() if disc.has(theirs)},
            **_trigger_behaviour(disc, scene),
        },
    )
    return with_companions(person, disc["amount"].read_integer(1, MOST_COMPANIONS) if disc.has("amount") else 1)


def _patrol_waypoints(disc: Field, start: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a round of waypoints (K, 2) from what is walked to the end: yoyo goes
    back the way it came, loop straight.
    """
    way = np.array([[waypoint.pose().x, waypoint.pose().y] for waypoint in disc["waypoints"].items()]).reshape(-1, 2)
    if not disc.has("is_waypoint_relative") or disc["is_waypoint_relative"].read_bool():
        way += start
    mode = _disc_mode(disc)
    if mode == "once" and len(way) == 1:
        return way  # who has one waypoint stands there on arrival
    back = way[:0] if mode == "loop" else way[-2::-1]
    return np.vstack((way, back, start)) if len(way) else way


def _disc_mode(disc: Field) -> str:
    if not disc.has("mode"):
        return "yoyo"
    if disc["mode"].value not in MODES:
        raise disc["mode"].rejection(", ".join(MODES))
    return str(disc["mode"].value)


def _disc_notes(disc: Field) -> list[str]:
    is_longer = _disc_mode(disc) == "once" and len(disc["waypoints"].items()) > 1
    return ["mode once goes to and fro here where it has several waypoints"] if is_longer else []


def _trigger_behaviour(disc: Field, scene: Field) -> dict[str, float | str]:
    """Return what makes a person wait until the robot is near one of the watchers of its triggers: a zone for each."""
    triggers = disc["triggers"].items() if disc.has("triggers") else []
    if len(triggers) > MOST_WATCHERS:
        raise disc["triggers"].rejection(f"at most {MOST_WATCHERS} watchers")
    zones = [_watcher_zone(trigger, scene, number) for number, trigger in enumerate(triggers, 1)]
    return (
        {"start_up_mode": "trigger_zone", **{key: value for zone in zones for key, value in zone.items()}}
        if zones
        else {}
    )


def _watcher_zone(trigger: Field, scene: Field, number: int) -> dict[str, float]:
    """Return the zone of a watcher; the keys of all but the first are numbered."""
    watchers = dict(scene["watchers"].entries()) if scene.has("watchers") else {}
    watcher = watchers.get(trigger.text())
    if watcher is None:
        raise trigger.rejection(", ".join(map(str, watchers)) or "no trigger, for the scene has no watchers")
    x, y = watcher["pos"].position().tolist()
    prefix = "trigger_zone" if number == 1 else f"trigger_zone_{number}"
    return {f"{prefix}_x": x, f"{prefix}_y": y, f"{prefix}_radius": watcher["range"].number(low=0.0)}
