"""Draw the pack ``arena``: maps, scenario files, pack.yaml and its Hydra options.

usage: python -m arena_scenarios [FOLDER]      (FOLDER gets packs/ and conf/; without it, those of this package are
written again)
"""

from __future__ import annotations

import sys
from pathlib import Path

from arena_core import random_generator
from arena_core.files import write_text_whole
from arena_core.hosting import load_registry
from arena_scenarios import plans
from arena_scenarios.halls import HALLS, hall_problem
from arena_scenarios.problems import write_problems
from arena_scenarios.situations import DENSITIES, SITUATIONS, draw_spaced

VERSION = "1.0.0"
TITLE = "What a robot meets among people: seven situations and three halls, each in three densities"
CROWDS = (5, 10, 20)  # people in a hall
VARIATIONS = 5  # problems a file
PLANS = {
    "ring": plans.ring_floor(20.0, 9.0, 3.0),
    "promenade": plans.ring_floor(24.0, 13.0, 4.0),
    "junctions": plans.junctions_floor(),
    "rooms": plans.rooms_floor(),
    "corner": plans.corner_floor(),
    "counter_hall": plans.counter_hall(),
}


def write_pack(folder: Path) -> None:
    """Write everything below ``folder``."""
    pack = folder / "packs" / "arena"
    for name, floor in {**PLANS, **{name: draw() for name, (draw, _) in HALLS.items()}}.items():
        floor.save(pack / "maps", name)
    _write_situations(pack)
    _write_halls(pack)
    _write_experiment(pack, folder / "conf" / "experiment" / "arena_pack.yaml")
    words = ["--id", "arena", "--version", VERSION, "--title", TITLE, "--licence", "MIT"]
    command = load_registry().component("command", "scenario").resolve()()
    command.run(
        ["pack", str(pack), *words, "--conf", str(folder / "conf"), "--address", "pkg://arena_scenarios/packs/arena"]
    )


def _write_situations(pack: Path) -> None:
    for situation, (plan, draw) in SITUATIONS.items():
        for density, number in DENSITIES.items():
            name = f"{situation}_{density}"
            title = f"{(draw.__doc__ or '').rstrip('.')} ({density} density)"
            problems = [
                draw_spaced(draw, number, random_generator(variation, name, "pack")) for variation in range(VARIATIONS)
            ]
            write_problems(pack / "scenarios" / f"{name}.json", title, f"../maps/{plan}.yaml", problems)


def _write_halls(pack: Path) -> None:
    for hall_name, (draw, routes) in HALLS.items():
        for people in CROWDS:
            name = f"{hall_name}_{people:02d}"
            title = f"{people} people walk about the robot's way ({hall_name})"
            problems = [
                hall_problem(draw(), route, people, random_generator(variation, name, "pack"))
                for variation, route in enumerate(routes)
            ]
            write_problems(pack / "scenarios" / f"{name}.json", title, f"../maps/{hall_name}.yaml", problems)


def _write_experiment(pack: Path, path: Path) -> None:
    names = ",".join(f"arena/{file.stem}" for file in sorted((pack / "scenarios").glob("*.json")))
    head = (
        "# @package _global_\n# Every scenario of the pack arena (docs/scenario_pack.md): a multirun; "
        "choose planner and robot.\n"
    )
    write_text_whole(path, f"{head}hydra:\n  mode: MULTIRUN\n  sweeper:\n    params:\n      scenario: {names}\n")


if __name__ == "__main__":
    if len(sys.argv) > 2 or any(given.startswith("-") for given in sys.argv[1:]):
        sys.exit(__doc__)
    write_pack(Path(sys.argv[1]) if len(sys.argv) == 2 else Path(__file__).parent)
