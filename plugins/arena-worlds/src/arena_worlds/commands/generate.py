"""``arena world generate``: draw a world and write it as a ROS map, with a picture and its measures."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from omegaconf import OmegaConf

from arena_core import WorldSource
from arena_core.commands import Command, Words, key_value, read_words
from arena_core.files import options_of, write_text_whole
from arena_core.hosting import compose, load_registry
from arena_core.parameters import NonNegativeInt, Positive
from arena_worlds.commands.measure import ROBOT_RADIUS, measures_table
from arena_worlds.commands.measures import Measures, measures_of
from arena_worlds.commands.portrait import write_portrait
from arena_worlds.formats.map_writer import write_map
from arena_worlds.formats.site_file import GAZEBO, MUJOCO, write_world
from arena_worlds.generators.dynabarn import DynabarnWorlds
from arena_worlds.generators.dynabarn_writer import write_set

OWN = ("kind", "seed", "out", "wall_height")  # all other words are parameters of the world
USAGE = (
    "arena world generate kind=indoor out=DIR|FILE.yaml|FILE.sdf|FILE.xml [seed=0] [wall_height=2.0] "
    "[difficulty=0.8] [width=...]"
)
WALL_HEIGHT = 2.0  # m; as high as doors
KINDS = {"barn": "cellular"}  # BARN's own worlds are files; what is drawn after its recipe has another name


class GenerateCommand(Command):
    """Draw a world and write it."""

    help: ClassVar[str] = f"draw a world: {USAGE}"

    def run(self, arguments: Sequence[str]) -> int:
        """Write the first world of a seed as FILE.yaml, FILE.pgm, FILE.png and FILE_measures.json, and print its
        measures.

        FILE.sdf, FILE.world and FILE.xml are a Gazebo world and a MuJoCo model of it, with its furniture, which no map
        holds.
        """
        words = read_words(USAGE, arguments, keys=OWN, overrides=None)
        kind, out = words.required("kind"), words.required("out")
        if kind == "dynabarn":
            return _write_dynabarn(words)
        path, seed = map_path(out), words.value("seed", NonNegativeInt, 0)
        node = world_parameters(KINDS.get(kind, kind), dict(map(key_value, words.overrides)))
        source: WorldSource = load_registry().build("world", node)
        world = source.world(seed, 0)
        if Path(out).suffix in (*GAZEBO, *MUJOCO):
            write_world(Path(out), world, words.value("wall_height", Positive, WALL_HEIGHT))
            print(f"written: {out}")
            return 0
        grid = world.grid
        measures = measures_of(grid, node.get("robot_radius", ROBOT_RADIUS))
        files = [*write_map(path, grid), path.with_suffix(".png"), path.with_name(f"{path.stem}_measures.json")]
        write_portrait(files[2], grid, _picture_title(node, seed))
        write_text_whole(files[3], _report_text(node, seed, measures))
        print("\n".join([*(f"written: {file}" for file in files), measures_table(measures)]))
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the worlds."""
        return (
            [f"kind={name}" for name in options_of("world", load_registry().manager)]
            if word.startswith("kind=")
            else ["kind=", "seed="]
        )


def _write_dynabarn(words: Words) -> int:
    """Write a set of worlds whose obstacles move: no map could hold them."""
    folder = Path(words.required("out"))
    node = {
        **world_parameters("dynabarn", dict(map(key_value, words.overrides))),
        "draw": words.value("seed", NonNegativeInt, 0),
    }
    source: DynabarnWorlds = load_registry().build("world", node)
    print("\n".join(f"written: {path}" for path in write_set(folder, source)))
    return 0


def world_parameters(kind: str, values: Mapping[str, str]) -> dict[str, Any]:
    """Return what ``world=KIND`` is with these parameters; raise ConfigurationError for one that it has not."""
    overrides = [
        f"world@world.room={value}" if key == "room" else f"world.{key}={value}" for key, value in values.items()
    ]
    return OmegaConf.to_container(compose(overrides, f"world/{kind}").world, resolve=True)  # type: ignore[return-value]


def map_path(out: str) -> Path:
    """Return the YAML file of a map to write: ``out`` itself if it ends in .yaml,
    else map.yaml in the folder ``out``.
    """
    path = Path(out)
    return path if path.suffix == ".yaml" else path / "map.yaml"


def _picture_title(node: Mapping[str, Any], seed: int) -> str:
    difficulty = f", difficulty {node['difficulty']:g}" if "difficulty" in node else ""
    return f"{node['name']}{difficulty}, seed {seed}"


def _report_text(node: Mapping[str, Any], seed: int, measures: Measures) -> str:
    figures = {name: {"value": value, "unit": unit, "meaning": text} for name, value, unit, text in measures.rows()}
    return json.dumps({"world": node, "seed": seed, "measures": figures}, indent=2) + "\n"
