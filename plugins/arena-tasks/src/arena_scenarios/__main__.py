"""Draw the packs ``arena``, ``francis2023`` and ``iso18646``: maps, scenario files, pack.yaml and their Hydra options.

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
from arena_scenarios.cards.pack import write_cards
from arena_scenarios.courses.pack import write_courses
from arena_scenarios.halls import HALLS, hall_problem
from arena_scenarios.problems import write_problems
from arena_scenarios.situations import DENSITIES, SITUATIONS, draw_spaced

VERSION = "1.0.0"
TITLES = {
    "arena": "What a robot meets among people: seven situations and three halls, each in three densities",
    "francis2023": "The 25 scenario cards of Francis et al. (ACM THRI 2025), each in three densities or speeds",
    "iso18646": "Courses for pose accuracy, path deviation, obstacles and narrow passages (ISO 18646-2)",
}
EXPERIMENTS = {"arena": "arena_pack.yaml", "francis2023": "francis2023.yaml", "iso18646": "iso18646.yaml"}
DOCS = {"iso18646": "docs/iso18646.md"}
CHOSEN = {
    "francis2023": "defaults:\n  - override /metrics: [si, social, company]\n\nepisodes: 5\n",
    "iso18646": "defaults:\n  - override /localizer: amcl\n\nepisodes: 10\ntask:\n  time_limit: 120.0\n",
}
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


def write_packs(folder: Path) -> None:
    """Write everything below ``folder``."""
    _write_arena(folder / "packs" / "arena")
    write_cards(folder / "packs" / "francis2023")
    write_courses(folder / "packs" / "iso18646")
    command = load_registry().component("command", "scenario").resolve()()
    for name, title in TITLES.items():
        pack = folder / "packs" / name
        _write_experiment(pack, folder / "conf" / "experiment" / EXPERIMENTS[name])
        words = ["--id", name, "--version", VERSION, "--title", title, "--licence", "MIT"]
        address = f"pkg://arena_scenarios/packs/{name}"
        command.run(["pack", str(pack), *words, "--conf", str(folder / "conf"), "--address", address])


def _write_arena(pack: Path) -> None:
    for name, floor in {**PLANS, **{name: draw() for name, (draw, _) in HALLS.items()}}.items():
        floor.save(pack / "maps", name)
    _write_situations(pack)
    _write_halls(pack)


def _write_situations(pack: Path) -> None:
    for situation, (plan, draw) in SITUATIONS.items():
        for density, number in DENSITIES.items():
            name = f"{situation}_{density}"
            title = f"{(draw.__doc__ or '').rstrip('.')} ({density} density)"
            problems = [
                draw_spaced(draw, number, random_generator(variation, name, "pack")) for variation in range(VARIATIONS)
            ]
            write_problems(pack / "scenarios" / f"{name}.json", {"title": title}, f"../maps/{plan}.yaml", problems)


def _write_halls(pack: Path) -> None:
    for hall_name, (draw, routes) in HALLS.items():
        for people in CROWDS:
            name = f"{hall_name}_{people:02d}"
            title = f"{people} people walk about the robot's way ({hall_name})"
            problems = [
                hall_problem(draw(), route, people, random_generator(variation, name, "pack"))
                for variation, route in enumerate(routes)
            ]
            write_problems(pack / "scenarios" / f"{name}.json", {"title": title}, f"../maps/{hall_name}.yaml", problems)


def _write_experiment(pack: Path, path: Path) -> None:
    names = ",".join(f"{pack.name}/{file.stem}" for file in sorted((pack / "scenarios").glob("*.json")))
    chosen = CHOSEN.get(pack.name, "")
    page = DOCS.get(pack.name, "docs/scenario_pack.md")
    head = (
        f"# @package _global_\n# Every scenario of the pack {pack.name} ({page}): a multirun; "
        "choose planner and robot.\n"
    )
    write_text_whole(
        path, f"{head}{chosen}hydra:\n  mode: MULTIRUN\n  sweeper:\n    params:\n      scenario: {names}\n"
    )


if __name__ == "__main__":
    if len(sys.argv) > 2 or any(given.startswith("-") for given in sys.argv[1:]):
        sys.exit(__doc__)
    write_packs(Path(sys.argv[1]) if len(sys.argv) == 2 else Path(__file__).parent)
