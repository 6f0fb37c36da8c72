"""Problems as scenario files state them: people on rounds, and how a file is written."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from arena_core.files import write_text_whole

Point = tuple[float, float]
RADIUS = 0.3  # m, of a person (release: random obstacles measure up to 0.3)


@dataclass(frozen=True, slots=True)
class Person:
    """A person who walks the round ``waypoints``, the first one first; none means standing. Metres and m/s."""

    position: Point
    waypoints: tuple[Point, ...]
    speed: float
    behaviour: dict[str, float | str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Doorway:
    """A door across the rectangle from ``low`` to ``high`` (m): ``open`` from .. to (s), for good without an end,
    again in each ``period`` (s).
    """

    low: Point
    high: Point
    open: tuple[float, ...]
    period: float | None = None


@dataclass(frozen=True, slots=True)
class Course:
    """What a problem may say beside way and people: its goal radius (m), discs (x, y, radius) that are on no map, with
    whom the robot is to keep, and a door, as scenario files do.
    """

    goal_radius: float | None = None
    discs: tuple[tuple[float, float, float], ...] = ()
    company: Mapping[str, object] | None = None
    door: Doorway | None = None


PLAIN = Course()


@dataclass(frozen=True, slots=True)
class Problem:
    """A robot's way from ``start`` (heading ``theta`` rad) to ``goal``, and who is there."""

    start: Point
    goal: Point
    theta: float
    people: tuple[Person, ...]
    course: Course = PLAIN


def write_problems(path: Path, about: Mapping[str, object], map_file: str, problems: Sequence[Problem]) -> None:
    """Write a scenario file; its problems are called after it, a .. z. One line a person, centimetres.

    ``about`` is its title, and its card if it has one.
    """
    head = {"format": "arena-scenario", "version": 2, **about, "map": map_file}
    lines = [f'  "{key}": {json.dumps(value)},' for key, value in head.items()]
    scenarios = [
        _problem_json(f"{path.stem}_{chr(ord('a') + number)}", problem) for number, problem in enumerate(problems)
    ]
    write_text_whole(path, "\n".join(["{", *lines, '  "scenarios": [', ",\n".join(scenarios), "  ]", "}", ""]))


def _problem_json(name: str, problem: Problem) -> str:
    start = [*_round_point(problem.start), round(problem.theta, 2)]
    people = ",\n".join(f"        {json.dumps(_person_entry(person))}" for person in problem.people)
    listed = f"[\n{people}\n      ]" if people else "[]"
    fields = [f'"name": {json.dumps(name)}', f'"start": {start}', f'"goal": {_round_point(problem.goal)}']
    fields += _course_fields(problem.course)
    return "    {\n" + ",\n".join(f"      {line}" for line in [*fields, f'"pedestrians": {listed}']) + "\n    }"


def _course_fields(course: Course) -> list[str]:
    discs = [{"center": [x, y], "radius": radius} for x, y, radius in course.discs]
    said = {
        "goal_radius": course.goal_radius,
        "company": dict(course.company) if course.company else None,
        "obstacles": discs or None,
        "doors": [_door_entry(course.door)] if course.door else None,
    }
    return [f'"{key}": {json.dumps(value)}' for key, value in said.items() if value is not None]


def _door_entry(door: Doorway) -> dict[str, Any]:
    (left, bottom), (right, top) = door.low, door.high
    entry = {
        "vertices": [[left, bottom], [right, bottom], [right, top], [left, top]],
        "open": [[round(stamp, 1) for stamp in door.open]],
    }
    return {**entry, "period": door.period} if door.period else entry


def _person_entry(person: Person) -> dict[str, Any]:
    waypoints = [_round_point(waypoint) for waypoint in person.waypoints]
    entry = {
        "position": _round_point(person.position),
        "waypoints": waypoints,
        "desired_speed": round(person.speed, 2),
        "radius": RADIUS,
    }
    return {**entry, "behaviour": person.behaviour} if person.behaviour else entry


def _round_point(point: Point) -> list[float]:
    return [round(float(point[0]), 2), round(float(point[1]), 2)]
