"""``arena world generate``: draw a world and write it as a ROS map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

from omegaconf import OmegaConf

from arena_core import Command, World, WorldSource, compose, load_registry
from arena_worlds.map_writer import write_map
from arena_worlds.words import key_values, map_path, required, whole_number

KINDS = {"barn": "cellular"}  # BARN's own worlds are files; what is drawn after its recipe has another name


class GenerateCommand(Command):
    """Draw a world and write it."""

    help: ClassVar[str] = "draw a world: arena world generate kind=indoor out=DIR|FILE.yaml [seed=0] [difficulty=0.8] [width=...]"

    def run(self, arguments: Sequence[str]) -> int:
        """Write the world that the words describe; all but kind, seed and out are parameters of ``world=KIND``."""
        words = key_values(arguments)
        kind, path = required(words, "kind", "indoor, ... (arena list world)"), map_path(required(words, "out", "DIR or FILE.yaml"))
        seed = whole_number(words, "seed", 0)
        for written in write_map(path, world_of(KINDS.get(kind, kind), words, seed).grid):
            print(f"written: {written}")
        return 0


def world_of(kind: str, words: Mapping[str, str], seed: int) -> World:
    """Return the first world of ``seed`` with the parameters that ``words`` hold beside kind, seed and out."""
    overrides = [f"world.{key}={value}" for key, value in words.items() if key not in ("kind", "seed", "out")]
    node = OmegaConf.to_container(compose(overrides, f"world/{kind}").world, resolve=True)
    source: WorldSource = load_registry().build("world", node)  # type: ignore[arg-type]
    return source.world(seed, 0)
