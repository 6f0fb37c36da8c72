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
from arena_studio.background.requests import DrawScenes, TaskRules
from arena_studio.background.scenes import cells_of, quote_text, world_of
from arena_tasks.scenario_files.scenario_file import content_of

MOST = 20
HEADS = {"random": "Random problems", "staged": "Levels of random problems"}


def draw_scenes(request: DrawScenes) -> dict[str, Any]:
    """Return the first scenes of a seed under some rules, and the maps that they lie on; raise ArenaError where the
    rules are impossible.
    """
    registry = load_registry()
    place = world_of(request.map) if request.map else [f"world={request.world}"]
    place += [] if request.difficulty is None else [f"world.difficulty={request.difficulty}"]
    words = [*place, f"robot={request.robot}", "task=random", *_rule_overrides(request.rules)]
    words = check_overrides(words, Path.cwd())
    node = to_plain(compose(words, "component"))
    source = registry.build("world", node["world"])
    body = registry.build("robot", node["robot"])
    task = registry.build("task", node["task"], robot=body, world=source)
    grids: list[OccupancyGrid] = []
    rows = [_draw_scene(task, request.seed, index, grids) for index in range(min(request.count, MOST))]
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


def task_option_text(request: TaskRules) -> str:
    """Return the option task=NAME, its ``task`` with these rules; raise ConfigurationError for a name that is
    taken, or a rule that is none.
    """
    name, rules, base = request.name, request.rules, request.task
    options = option_files("task", load_registry().manager)
    if name in options:
        raise ConfigurationError(f"name is {name}; allowed: another one than {', '.join(options)}")
    compose(check_overrides([f"task={base}", *_rule_overrides(rules)], Path.cwd()), "component")
    tree: dict[str, Any] = {}
    for key, value in rules.items():
        *above, last = key.split(".")
        node = tree
        for group in above:
            node = node.setdefault(group, {})
        node[last] = value
    head = f"# {HEADS[base]} with rules of your own: {name}.\ndefaults:\n  - {base}\n  - _self_\n"
    return head + (yaml.safe_dump(tree, sort_keys=False) if tree else "")


def _rule_overrides(rules: Mapping[str, Any]) -> list[str]:
    return [f"task.{key}={_hydra_value(value)}" for key, value in rules.items()]


def _hydra_value(value: Any) -> str:
    """Return a value as Hydra's grammar has it."""
    return (
        quote_text(value) if isinstance(value, str) else str(value).lower() if isinstance(value, bool) else repr(value)
    )
