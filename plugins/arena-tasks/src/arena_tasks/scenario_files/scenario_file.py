"""Scenario files: our own JSON format (docs/scenarios.md), read and written, and which format a file has."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from arena_core import InputFileError, Obstacle, PedestrianSpec, Scenario
from arena_core.commands import one_line
from arena_core.files import LIMITS, write_text_whole
from arena_tasks.scenario_files.arena_rosnav import is_arena_rosnav, read_arena_rosnav
from arena_tasks.scenario_files.arena_tools import is_arena_tools, read_arena_tools
from arena_tasks.scenario_files.card import Card, read_card
from arena_tasks.scenario_files.company import read_company
from arena_tasks.scenario_files.doors import door_entry, read_door
from arena_tasks.scenario_files.flatland import is_flatland, read_flatland
from arena_tasks.scenario_files.furniture import piece_entry, read_piece
from arena_tasks.scenario_files.json_fields import Field, read_json
from arena_tasks.scenario_files.outlines import read_polygon
from arena_tasks.scenario_files.problem import MOST_REPEATS, Keys, PersonDefaults, Problem
from arena_tasks.scenario_files.robots import read_robots, robot_entries

FORMAT, VERSION = "arena-scenario", 2
READABLE = (1, VERSION)
FOREIGN = (  # formats of other programs: their names, whether a file has it, and what reads its problems
    ("arena-rosnav", is_arena_rosnav, read_arena_rosnav),  # ahead of arena-tools, whose name some of its files carry
    ("arena-tools", is_arena_tools, read_arena_tools),
    ("flatland", is_flatland, read_flatland),
)


@dataclass(frozen=True, slots=True, eq=False)
class ScenarioFile:
    """What a file holds: problems in their order, ``title`` says what they are, ``card`` what they are good for, if it
    has one, ``map`` is their map's YAML file, relative to the file.

    The task takes its map from ``world``; ``map`` tells whoever packs or converts the file. Empty: the file does not
    say.
    """

    problems: tuple[Problem, ...]
    title: str = ""
    map: str = ""
    card: Card | None = None


def read_scenarios(path: str | Path, defaults: PersonDefaults) -> tuple[Problem, ...]:
    """Read all problems of a file in one of the formats of docs/formats.md; raise InputFileError with file and key."""
    return read_scenario_file(path, defaults).problems


def read_scenario_file(path: str | Path, defaults: PersonDefaults) -> ScenarioFile:
    """Read a file in one of the formats of docs/formats.md; raise InputFileError with file and key."""
    return read_content(read_json(path), defaults)


def read_content(root: Field, defaults: PersonDefaults) -> ScenarioFile:
    """Read what a file holds; raise InputFileError with file and key."""
    written = format_of(root)
    if written == FORMAT:
        return _within_limits(root.file, _read_ours(root, defaults))
    for name, _, read in FOREIGN:
        if name == written:
            return _within_limits(root.file, ScenarioFile(read(root, defaults)))
    raise InputFileError(
        f"{root.file}: has neither format: {FORMAT} nor pedsim_agents, scenarios or robots; allowed: "
        "a file as in docs/formats.md"
    )


def format_of(root: Field) -> str:
    """Return the name of a content's format, empty where it is no scenario's; raise
    InputFileError where it is no mapping.
    """
    if root.has("format") and root["format"].value == FORMAT:
        return FORMAT
    return next((name for name, is_it, _ in FOREIGN if is_it(root)), "")


def _within_limits(path: Path, file: ScenarioFile) -> ScenarioFile:
    """Return the file; raise InputFileError for a problem with more people or obstacles, or
    larger ones, than can be run.
    """
    for problem in file.problems:
        extents = [person.radius for person in problem.pedestrians]
        extents += [
            max(obstacle.radius, float(np.ptp(obstacle.vertices_xy, axis=0).max())) for obstacle in problem.obstacles
        ]
        extents += [float(np.ptp(door.vertices_xy, axis=0).max()) for door in problem.doors]
        for what, found, most in (
            ("people", len(problem.pedestrians), LIMITS.people),
            ("obstacles", len(problem.obstacles), LIMITS.obstacles),
            ("doors", len(problem.doors), LIMITS.doors),
            ("pieces of furniture", len(problem.furniture), LIMITS.furniture),
            ("m of a body", max(extents, default=0.0), LIMITS.body_extent),
        ):
            if found > most:
                raise InputFileError(
                    f"{path}: {one_line(problem.name, 60)} has {found:g} {what}; allowed: up to {most:g}"
                )
    return file


def save_scenarios(
    path: str | Path, scenarios: Sequence[Scenario | Problem], title: str = "", map_file: str = ""
) -> None:
    """Write scenarios in our format, whole or not at all; ``map_file`` is their
    map's YAML file, relative to ``path``.
    """
    write_text_whole(path, scenario_text(content_of(scenarios, title, map_file)))


def content_of(scenarios: Sequence[Scenario | Problem], title: str = "", map_file: str = "") -> dict[str, Any]:
    """Return what a file of ours holds, as JSON has it."""
    said = {key: text for key, text in (("title", title), ("map", map_file)) if text}
    return {
        "format": FORMAT,
        "version": VERSION,
        **said,
        "scenarios": [_problem_entry(scenario) for scenario in scenarios],
    }


def scenario_text(content: Mapping[str, Any]) -> str:
    """Return the text of a file of ours with this content."""
    return _with_short_lists(json.dumps(content, indent=2, allow_nan=False)) + "\n"


def _with_short_lists(text: str) -> str:
    """Put each list of numbers on one line; a line break inside a text is written \\n, so none of these is one."""
    return re.sub(r"\[\n\s+([^\[\]{}\"]*?)\n\s*\]", lambda found: "[" + re.sub(r",\n\s+", ", ", found[1]) + "]", text)


def _read_ours(root: Field, defaults: PersonDefaults) -> ScenarioFile:
    root.check_keys("format", "version", "title", "card", "map", "scenarios")
    if root["version"].value not in READABLE:
        raise root["version"].rejection(" or ".join(map(str, READABLE)))
    problems = tuple(_read_problem(field, defaults) for field in root["scenarios"].items())
    names = set[str]()
    for number, problem in enumerate(problems):
        if problem.name in names:
            raise root["scenarios"].items()[number]["name"].rejection("names that differ from each other")
        names.add(problem.name)
    if not problems:
        raise root["scenarios"].rejection("at least one scenario")
    title, map_file = (root[key].text() if root.has(key) else "" for key in ("title", "map"))
    return ScenarioFile(problems, title, map_file, read_card(root["card"]) if root.has("card") else None)


def _read_problem(field: Field, defaults: PersonDefaults) -> Problem:
    field.check_keys(
        "name",
        "repeats",
        "start",
        "goal",
        "pedestrians",
        "obstacles",
        "doors",
        "furniture",
        "goal_radius",
        "time_limit",
        "company",
        "robots",
    )
    if field.has("robots") and (field.has("start") or field.has("goal") or field.has("company")):
        raise field["robots"].rejection("no robots beside start, goal or company, which are of one robot")
    start, goal, team = (
        read_robots(field["robots"]) if field.has("robots") else (field["start"].pose(), field["goal"].pose(), ())
    )
    own = f"{field['robots'].key}[0]" if team else field.key
    people = field["pedestrians"].items() if field.has("pedestrians") else []
    obstacles = field["obstacles"].items() if field.has("obstacles") else []
    return Problem(
        name=field["name"].text(),
        start=start,
        goal=goal,
        pedestrians=tuple(_read_person(number, person, defaults) for number, person in enumerate(people)),
        obstacles=tuple(_read_obstacle(obstacle) for obstacle in obstacles),
        goal_radius=field["goal_radius"].number(above=0.0) if field.has("goal_radius") else None,
        time_limit=field["time_limit"].number(above=0.0) if field.has("time_limit") else None,
        keys=Keys(
            f"{own}.start",
            f"{own}.goal",
            tuple(person.key for person in people),
            tuple(robot.key for robot in field["robots"].items()[1:]) if team else (),
        ),
        repeats=field["repeats"].read_integer(1, MOST_REPEATS) if field.has("repeats") else 1,
        furniture=tuple(map(read_piece, field["furniture"].items())) if field.has("furniture") else (),
        company=read_company(field["company"], len(people)) if field.has("company") else None,
        doors=tuple(map(read_door, field["doors"].items())) if field.has("doors") else (),
        team=team,
    )


def _read_person(number: int, field: Field, defaults: PersonDefaults) -> PedestrianSpec:
    field.check_keys("position", "waypoints", "desired_speed", "max_speed", "radius", "behaviour")
    if field.has("desired_speed") and field.has("max_speed"):
        raise field["max_speed"].rejection("desired_speed alone, of which this is the former name")
    speed = next(
        (field[key].number(above=0.0) for key in ("desired_speed", "max_speed") if field.has(key)), defaults.speed
    )
    return PedestrianSpec(
        id=number,
        position_xy=field["position"].position(),
        waypoints_xy=field["waypoints"].positions() if field.has("waypoints") else np.empty((0, 2)),
        desired_speed=speed,
        radius=field["radius"].number(above=0.0) if field.has("radius") else defaults.radius,
        behaviour={name: _read_behaviour(value) for name, value in field["behaviour"].entries()}
        if field.has("behaviour")
        else {},
    )


def _read_behaviour(field: Field) -> float | str:
    return field.value if isinstance(field.value, str) else field.number()


def _read_obstacle(field: Field) -> Obstacle:
    if field.has("center"):
        field.check_keys("center", "radius")
        return Obstacle(field["center"].position()[None], field["radius"].number(above=0.0))
    field.check_keys("vertices")
    return Obstacle(read_polygon(field["vertices"]))


def _problem_entry(scenario: Scenario | Problem) -> dict[str, Any]:
    furniture = scenario.furniture if isinstance(scenario, Problem) else scenario.world.furniture
    own = {
        "repeats": scenario.repeats if isinstance(scenario, Problem) and scenario.repeats > 1 else None,
        "goal_radius": scenario.goal_radius,
        "time_limit": scenario.time_limit,
    }
    ends = {"start": scenario.start.array().tolist(), "goal": scenario.goal.array().tolist()}
    if scenario.team:
        ends = {"robots": robot_entries(scenario.start, scenario.goal, scenario.team)}
    return {
        "name": scenario.name,
        **ends,
        **{key: value for key, value in own.items() if value is not None},
        "pedestrians": [_person_entry(person) for person in scenario.pedestrians],
        "obstacles": [_obstacle_entry(obstacle) for obstacle in scenario.obstacles],
        **({"doors": list(map(door_entry, scenario.doors))} if scenario.doors else {}),
        **({"furniture": list(map(piece_entry, furniture))} if furniture else {}),
        **({"company": asdict(scenario.company)} if scenario.company else {}),
    }


def _person_entry(person: PedestrianSpec) -> dict[str, Any]:
    return {
        "position": person.position_xy.tolist(),
        "waypoints": person.waypoints_xy.tolist(),
        "desired_speed": person.desired_speed,
        "radius": person.radius,
        "behaviour": person.behaviour,
    }


def _obstacle_entry(obstacle: Obstacle) -> dict[str, Any]:
    if obstacle.radius > 0.0:
        return {"center": obstacle.vertices_xy[0].tolist(), "radius": obstacle.radius}
    return {"vertices": obstacle.vertices_xy.tolist()}
