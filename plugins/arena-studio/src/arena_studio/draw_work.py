"""What rules of random problems draw: some scenes, each on its map, or why there is none."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from arena_core import ArenaError, ConfigurationError, OccupancyGrid, TaskMode
from arena_core.files import option_files
from arena_core.hosting import compose, load_registry, to_plain
from arena_studio.allowed_overrides import check_overrides
from arena_studio.scene_work import cells_of, quote_text, world_of
from arena_tasks.scenario_files.scenario_file import content_of

MOST = 20
HEADS = {"random": "Random problems", "staged": "Levels of random problems"}


def draws(
    rules: Mapping[str, Any], world: str, map_file: str, difficulty: float | None, robot: str, seed: int, count: int
) -> dict[str, Any]:
    """Return the first scenes of a seed under some rules, and the maps that they lie on; raise ArenaError where the
    rules are impossible.

    ``rules`` are parameters of task=random by their dotted names. They are drawn in a map of the project, or else in a
    world by its name.
    """
    registry = load_registry()
    place = world_of(map_file) if map_file else [f"world={world}"]
    place += [] if difficulty is None else [f"world.difficulty={difficulty}"]
    overrides = [f"task.{key}={_hydra_value(value)}" for key, value in rules.items()]
    words = check_overrides([*place, f"robot={robot}", "task=random", *overrides], Path.cwd())
    node = to_plain(compose(words, "component"))
    source = registry.build("world", node["world"])
    body = registry.build("robot", node["robot"])
    task = registry.build("task", node["task"], robot=body, world=source)
    grids: list[OccupancyGrid] = []
    rows = [_draw_scene(task, seed, index, grids) for index in range(min(count, MOST))]
    return {"maps": [cells_of(grid) for grid in grids], "draws": rows}


def _draw_scene(task: TaskMode, seed: int, index: int, grids: list[OccupancyGrid]) -> dict[str, Any]:
    """Return one scene with the number of its map, or its error; a map that is not there yet
    goes to the end of ``grids``.
    """
    try:
        scenario = task.scenario(seed, index)
    except ArenaError as error:
        return {"error": str(error)}
    grid = scenario.world.grid
    if not any(grid is other for other in grids):
        grids.append(grid)
    number = next(k for k, other in enumerate(grids) if other is grid)
    return {"map": number, "scene": content_of([scenario])["scenarios"][0]}


def rules_text(name: str, rules: Mapping[str, Any], base: str) -> str:
    """Return the option task=NAME, ``base`` with these rules; raise ConfigurationError for a name that is
    taken, or a rule that is none.
    """
    options = option_files("task", load_registry().manager)
    if name in options:
        raise ConfigurationError(f"name is {name}; allowed: another one than {', '.join(options)}")
    words = [f"task={base}", *(f"task.{key}={_hydra_value(value)}" for key, value in rules.items())]
    compose(check_overrides(words, Path.cwd()), "component")
    tree: dict[str, Any] = {}
    for key, value in rules.items():
        *above, last = key.split(".")
        node = tree
        for group in above:
            node = node.setdefault(group, {})
        node[last] = value
    head = f"# {HEADS[base]} with rules of your own: {name}.\ndefaults:\n  - {base}\n  - _self_\n"
    return head + (yaml.safe_dump(tree, sort_keys=False) if tree else "")


def _hydra_value(value: Any) -> str:
    """Return a value as Hydra's grammar has it."""
    return (
        quote_text(value) if isinstance(value, str) else str(value).lower() if isinstance(value, bool) else repr(value)
    )
