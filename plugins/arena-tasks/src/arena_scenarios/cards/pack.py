"""Drawing the pack ``francis2023``: three levels of each card, five variations of each."""

from __future__ import annotations

from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import yaml

from arena_core import random_generator
from arena_scenarios.cards import companions, crossings, crowds, encounters, floors, rooms
from arena_scenarios.floor import Floor
from arena_scenarios.plans import corner_floor
from arena_scenarios.problems import Problem, write_problems
from arena_scenarios.situations import DENSITIES, Random, draw_spaced

KEEP_OFF = 0.95  # m, least distance of people from the robot at the start: the chord of a small group
VARIATIONS = 5  # problems a file
PLANS: dict[str, Callable[[], Floor]] = {
    **{
        draw.__name__: draw
        for draw in (
            floors.corridor,
            floors.crossing,
            floors.hallway,
            floors.doorway,
            floors.office,
            floors.lobby,
            floors.plaza,
        )
    },
    "corner": corner_floor,
}
MODULES = (encounters, crossings, rooms, companions, crowds)


def cards() -> dict[str, dict[str, Any]]:
    """Return what cards.yaml says of each card, by its name."""
    said: dict[str, dict[str, Any]] = yaml.safe_load((files("arena_scenarios.cards") / "cards.yaml").read_text("utf-8"))
    return said


def drawing_of(name: str) -> Callable[[int, Random], Problem]:
    """Return the function that draws a card's problems."""
    draw: Callable[[int, Random], Problem] = next(getattr(part, name) for part in MODULES if hasattr(part, name))
    return draw


def write_cards(pack: Path) -> None:
    """Write maps and scenario files of all cards below the pack's folder."""
    for name, plan in PLANS.items():
        plan().save(pack / "maps", name)
    for card, said in cards().items():
        for level, number in DENSITIES.items():
            name = f"{card}_{level}"
            problems = [
                draw_spaced(drawing_of(card), number, random_generator(variation, name, "pack"), KEEP_OFF)
                for variation in range(VARIATIONS)
            ]
            about = {
                "title": f"{said['title']} ({level})",
                "card": {key: said[key] for key in ("letter", "tests", "good", "metrics")},
            }
            write_problems(pack / "scenarios" / f"{name}.json", about, f"../maps/{said['plan']}.yaml", problems)
