"""``arena world generate``: draw a world and write it as a ROS map, with a picture and its measures."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from omegaconf import OmegaConf

from arena_core import Command, WorldSource, compose, load_registry, write_text_whole
from arena_worlds.dynabarn import DynabarnWorlds
from arena_worlds.dynabarn_writer import write_set
from arena_worlds.map_writer import write_map
from arena_worlds.measure import ROBOT_RADIUS, table
from arena_worlds.measures import Measures, measures_of
from arena_worlds.portrait import write_portrait
from arena_worlds.words import key_values, map_path, required, whole_number

OWN = ("kind", "seed", "out")  # all other words are parameters of the world
KINDS = {"barn": "cellular"}  # BARN's own worlds are files; what is drawn after its recipe has another name


class GenerateCommand(Command):
    """Draw a world and write it."""

    help: ClassVar[str] = "draw a world: arena world generate kind=indoor out=DIR|FILE.yaml [seed=0] [difficulty=0.8] [width=...]"

    def run(self, arguments: Sequence[str]) -> int:
        """Write the first world of a seed as FILE.yaml, FILE.pgm, FILE.png and FILE_measures.json, and print its measures."""
        words = key_values(arguments)
        if words.get("kind") == "dynabarn":
            return _write_dynabarn(words)
        kind, path = required(words, "kind", "indoor, ... (arena list world)"), map_path(required(words, "out", "DIR or FILE.yaml"))
        seed = whole_number(words, "seed", 0)
        node = parameters(KINDS.get(kind, kind), words)
        source: WorldSource = load_registry().build("world", node)
        grid = source.world(seed, 0).grid
        measures = measures_of(grid, node.get("robot_radius", ROBOT_RADIUS))
        files = [*write_map(path, grid), path.with_suffix(".png"), path.with_name(f"{path.stem}_measures.json")]
        write_portrait(files[2], grid, _title(node, seed))
        write_text_whole(files[3], _report(node, seed, measures))
        print("\n".join([*(f"written: {file}" for file in files), table(measures)]))
        return 0


def _write_dynabarn(words: Mapping[str, str]) -> int:
    """Write a set of worlds whose obstacles move: no map could hold them."""
    folder = Path(required(words, "out", "DIR"))
    node = {**parameters("dynabarn", words), "draw": whole_number(words, "seed", 0)}
    source: DynabarnWorlds = load_registry().build("world", node)
    print("\n".join(f"written: {path}" for path in write_set(folder, source)))
    return 0


def parameters(kind: str, words: Mapping[str, str]) -> dict[str, Any]:
    """Return what ``world=KIND`` is with the parameters among ``words``; raise ConfigurationError for one that it has not."""
    overrides = [f"world.{key}={value}" for key, value in words.items() if key not in OWN]
    return OmegaConf.to_container(compose(overrides, f"world/{kind}").world, resolve=True)  # type: ignore[return-value]


def _title(node: Mapping[str, Any], seed: int) -> str:
    difficulty = f", difficulty {node['difficulty']:g}" if "difficulty" in node else ""
    return f"{node['name']}{difficulty}, seed {seed}"


def _report(node: Mapping[str, Any], seed: int, measures: Measures) -> str:
    figures = {name: {"value": value, "unit": unit, "meaning": text} for name, value, unit, text in measures.rows()}
    return json.dumps({"world": node, "seed": seed, "measures": figures}, indent=2) + "\n"
