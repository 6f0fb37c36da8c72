"""What rules of random problems draw: some scenes, each on its map, or why there is none."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from arena_core import ArenaError, OccupancyGrid, TaskMode, compose, load_registry, plain
from arena_studio.scene_work import cells_of, quoted, world_of
from arena_tasks.scenario_files.scenario_file import content_of

MOST = 20


def draws(
    rules: Mapping[str, Any], world: str, map_file: str, difficulty: float | None, robot: str, seed: int, count: int
) -> dict[str, Any]:
    """Return the first scenes of a seed under some rules, and the maps that they lie on; raise ArenaError where the rules are impossible.

    ``rules`` are parameters of task=random by their dotted names. They are drawn in a map of the project, or else in a world by its name.
    """
    registry = load_registry()
    place = world_of(map_file) if map_file else [f"world={world}"]
    place += [] if difficulty is None else [f"world.difficulty={difficulty}"]
    overrides = [f"task.{key}={_written(value)}" for key, value in rules.items()]
    node = plain(compose([*place, f"robot={robot}", "task=random", *overrides], "component"))
    source = registry.build("world", node["world"])
    body = registry.build("robot", node["robot"])
    task = registry.build("task", node["task"], robot=body, world=source)
    grids: list[OccupancyGrid] = []
    rows = [_drawn(task, seed, index, grids) for index in range(min(count, MOST))]
    return {"maps": [cells_of(grid) for grid in grids], "draws": rows}


def _drawn(task: TaskMode, seed: int, index: int, grids: list[OccupancyGrid]) -> dict[str, Any]:
    """Return one scene with the number of its map, or its error; a map that is not there yet goes to the end of ``grids``."""
    try:
        scenario = task.scenario(seed, index)
    except ArenaError as error:
        return {"error": str(error)}
    grid = scenario.world.grid
    if not any(grid is other for other in grids):
        grids.append(grid)
    number = next(k for k, other in enumerate(grids) if other is grid)
    return {"map": number, "scene": content_of([scenario])["scenarios"][0]}


def _written(value: Any) -> str:
    """Return a value as Hydra's grammar has it."""
    return quoted(value) if isinstance(value, str) else str(value).lower() if isinstance(value, bool) else repr(value)
