"""Worlds that are drawn by kind and difficulty, as ``arena world generate`` draws
them, and the measures of any world.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from omegaconf import OmegaConf

from arena_core import ArenaError, ConfigurationError, OccupancyGrid, World
from arena_core.commands import one_line
from arena_core.files import option_files, options_of
from arena_core.hosting import compose, load_registry
from arena_core.parameters import NonNegativeInt, read_settings
from arena_studio.project import Project
from arena_worlds.commands.convert import DEFAULTS
from arena_worlds.formats.site_file import site_grid

READ = {"path", "maps"}  # parameters of worlds that are read from files
MOVING = "dynabarn"  # fields whose obstacles no map can hold
DECIDED = "by_difficulty"
OWN = ("name", "known", "regenerate")  # parameters that a drawn map does not have
MOST_PARAMETERS, LONGEST_NAME = 100, 60


def drawable_kinds() -> list[dict[str, Any]]:
    """Return the kinds of worlds that can be drawn, each with its parameters; None
    is one that the difficulty decides.
    """
    found = []
    for name in options_of("world", load_registry().manager):
        try:
            node = OmegaConf.to_container(compose([], f"world/{name}").world, resolve=True)
        except ArenaError:
            continue  # one that cannot be composed alone cannot be drawn alone
        if isinstance(node, Mapping) and not READ & node.keys() and name != MOVING:
            found.append({"name": name, "parameters": _plain_parameters(node)})
    return found


def _plain_parameters(node: Mapping[Any, Any]) -> dict[str, float | bool | None]:
    decided = node.get(DECIDED) or {}
    shown = {key: value for key, value in node.items() if key not in OWN and isinstance(value, int | float)}
    return {**shown, **dict.fromkeys(key for key in decided if node.get(key) is None)}


def read_parameters(text: str) -> dict[str, Any]:
    """Return parameters that the page has sent as JSON; raise ConfigurationError."""
    try:
        values = json.loads(text)
    except (ValueError, RecursionError):
        values = None
    if not isinstance(values, dict) or len(values) > MOST_PARAMETERS:
        raise ConfigurationError(f"parameters is {one_line(text, 60)}; allowed: numbers by name, in JSON")
    return values


def draw_world(kind: str, seed: Any, values: Mapping[str, Any]) -> World:
    """Return the first world of a seed; raise ConfigurationError for a parameter that the kind has not or a
    value that it cannot have.
    """
    if kind not in option_files("world", load_registry().manager):
        raise ConfigurationError(
            f"kind is {one_line(kind, 40)!r}; allowed: {', '.join(one['name'] for one in drawable_kinds())}"
        )
    from arena_worlds.commands.generate import world_parameters

    given = {key: _format_word(key, value) for key, value in values.items() if value is not None}
    node = world_parameters(kind, given)
    if READ & node.keys():
        raise ConfigurationError(
            f"kind {kind} reads files; allowed: {', '.join(one['name'] for one in drawable_kinds())}"
        )
    number: int = read_settings(seed, NonNegativeInt, "seed")
    world: World = load_registry().build("world", node).world(number, 0)
    return world


def _format_word(key: str, value: Any) -> str:
    """Return a value as a word of the command line has it: a number or a truth, so that no word
    can smuggle in another override.
    """
    if not key.isidentifier() or len(key) > LONGEST_NAME or not isinstance(value, int | float):
        raise ConfigurationError(f"{one_line(key, 40)} is {one_line(str(value), 40)}; allowed: numbers")
    return str(value).lower() if isinstance(value, bool) else repr(value)


def measure_map(grid: OccupancyGrid, robot_radius: float | None) -> list[dict[str, Any]]:
    """Return how difficult a map is, as ``arena world measure`` says it: name, value, unit and meaning;
    raise ConfigurationError.
    """
    from arena_worlds.commands.measure import ROBOT_RADIUS
    from arena_worlds.commands.measures import measures_of

    radius = ROBOT_RADIUS if robot_radius is None else robot_radius
    return [
        {"name": name, "value": value, "unit": unit, "text": text}
        for name, value, unit, text in measures_of(grid, radius).rows()
    ]


def measure_file(project: Project, path: str, robot_radius: float | None) -> list[dict[str, Any]]:
    """Return how difficult a world of the project is; raise ArenaError."""
    return measure_map(site_grid(project.path(path), DEFAULTS["resolution"], DEFAULTS["margin"]), robot_radius)
