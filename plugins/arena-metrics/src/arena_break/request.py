"""What a search is asked for, and the folder in which it goes on."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arena_break.bounds import SearchBounds, read_bounds
from arena_break.course import Course
from arena_core import ConfigurationError, Robot, World
from arena_core.commands import Words, key_value
from arena_core.files import read_json, write_text_whole
from arena_core.hosting import Registry, compose, digest_code, to_plain
from arena_core.parameters import NonNegativeInt, PositiveInt

SETTINGS = "settings.json"
BUDGET, COUNT = 480, 12  # problems that a search tries, and problems of its pack
OWN = (
    "task",
    "seed",
    "episodes",
    "experiment",
    "report",
    "reference",
    "scenario",
    "metrics",
)  # the search chooses them


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """A planner on a robot in a world, and how it is searched against."""

    facts: Mapping[str, Any]
    course: Course
    words: tuple[str, ...]
    budget: int
    count: int
    folder: Path

    @property
    def bounds(self) -> SearchBounds:
        """Return within what problems are searched."""
        return self.course.bounds

    @property
    def name(self) -> str:
        """Return the name of the pack's file, and what its problems' names begin with."""
        return f"{file_name(self.facts['preset'])}_{file_name(self.facts['robot'])}"

    @property
    def seed(self) -> int:
        """Return the seed of the search."""
        return int(self.facts["seed"])


def read_request(words: Words, registry: Registry) -> Request:
    """Return what the words ask for; raise ConfigurationError or InputFileError before anything is written."""
    preset, robot = words.required("planner"), words.keys.get("robot", "turtlebot3")
    world = words.keys.get("world", "warehouse")
    given = [key_value(word)[0] for word in words.overrides]
    for key in given:
        if key.partition(".")[0] in OWN:
            raise ConfigurationError(f"{key} is given; allowed: keys that the search does not choose itself")
    if "reaction" in {key.rpartition(".")[2] for key in given} or "people" in given:
        raise ConfigurationError("people are chosen; allowed: those who ignore the robot, whom the search lays out")
    bounds = read_bounds(words.keys.get("bounds"))
    seed, budget = words.value("seed", NonNegativeInt, 0), words.value("budget", PositiveInt, BUDGET)
    if budget < bounds.batch:
        raise ConfigurationError(f"budget is {budget}; allowed: {bounds.batch} problems at least, for one batch")
    common = (f"planner={preset}", f"robot={robot}", *words.overrides)
    config = to_plain(compose([*_without_world(common), f"world={world}"]))
    own = tuple(word for word in common if not key_value(word)[0].startswith("world."))
    facts = {
        "planner": config["planner"]["name"],
        "preset": preset,
        "robot": robot,
        "world": world,
        "words": [word for word in words.overrides if not key_value(word)[0].startswith("executor")],
        "seed": seed,
        "budget": budget,
        "count": words.value("count", PositiveInt, COUNT),
        "bounds": bounds.facts(),
        "code": digest_code(config, registry).digest,
    }
    made: Robot = registry.build("robot", config["robot"])
    ground: World = registry.build("world", config["world"]).world(bounds.map_seed + seed, 0)
    place = words.keys.get("out", f"broken/{file_name(preset)}_{file_name(robot)}_{file_name(world)}_{seed}")
    return Request(facts, Course(ground, made, bounds), own, budget, facts["count"], Path(place))


def _without_world(words: tuple[str, ...]) -> list[str]:
    """Return words with the keys of the world behind the choice of the world."""
    return sorted(words, key=lambda word: word.startswith("world."))


def open_folder(request: Request, *, resume: bool) -> None:
    """Write what is asked for to a new folder, or check it against what is there; raise ConfigurationError for a folder
    that holds a search (unless ``resume``), or one of another request or code.
    """
    file = request.folder / SETTINGS
    wanted = json.loads(json.dumps(request.facts))
    if not file.exists():
        request.folder.mkdir(parents=True, exist_ok=True)
        write_text_whole(file, json.dumps(wanted, indent=1) + "\n")
        return
    if not resume:
        raise ConfigurationError(
            f"{request.folder} holds a search already; resume=true goes on with it, out=DIR is another one"
        )
    before = read_json(file, "what `arena break` wrote")
    then = before if isinstance(before, dict) else {}
    changed = [key for key in sorted(wanted.keys() | then.keys()) if then.get(key) != wanted.get(key)]
    if changed:
        raise ConfigurationError(
            f"{request.folder} holds a search with another {changed[0]}; resume=true goes on with the same one alone"
        )


def file_name(text: str) -> str:
    """Return a text as a file may be called."""
    return re.sub(r"[^A-Za-z0-9_]+", "_", text)
