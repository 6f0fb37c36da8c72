"""How the planner of a run was tuned, and the stack that guides it: what the cards beside their presets say, else what
is known without one.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib.resources.abc import Traversable
from typing import Any

from pluggy import PluginManager

from arena_core.base.errors import ConfigurationError
from arena_core.config.option_folders import option_files
from arena_core.config.presets import TUNING
from arena_core.config.search_spaces import value_at

CARD = ".card.json"  # ending of the card beside a preset's file
BY_HAND = "by hand, no card"
UNTUNED = "not for this robot"
STACK = "stack"  # the group of presets of localiser, tracker and recoveries together
LARGEST = 2**22  # characters of a card that is read


def tuning_of(config: Mapping[str, Any], manager: PluginManager) -> dict[str, Any]:
    """Return how the planner of a configuration was tuned, and the budget in episodes: 0 where no card tells one; and,
    where a stack was chosen, the same of that.
    """
    choices = config.get("choices", {})
    preset = str(choices.get("planner", config["planner"]["name"]))
    card = _card_of_robot(choices, manager) or _read_card(option_files("planner", manager).get(preset), preset)
    told = {"preset": preset, "tuned": _without_card(preset, choices, manager), "budget": 0}
    found = _told_by(card, preset, config["planner"]) if card else told
    return {**found, STACK: _tuning_of_stack(config, str(choices[STACK]), manager)} if STACK in choices else found


def _tuning_of_stack(config: Mapping[str, Any], preset: str, manager: PluginManager) -> dict[str, Any]:
    card = _read_card(option_files(STACK, manager).get(preset), preset)
    if card is None:
        return {"preset": preset, "tuned": _whose(f"_{preset}") or BY_HAND, "budget": 0}
    found = _told_by(card, preset, config)
    return {**found, "tuned": f"{found['tuned']}, with {card.get('planner')}"}


def _told_by(card: Mapping[str, Any], preset: str, node: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a card says of a preset whose values stand in a node of the configuration now."""
    found = {"preset": preset, "tuned": _by_card(card, node), "budget": card.get("budget", {}).get("episodes", 0)}
    return {**found, "card": {key: card.get(key) for key in ("code", "seed", "robot", "verdict")}}


def _card_of_robot(choices: Mapping[str, str], manager: PluginManager) -> dict[str, Any] | None:
    """Return the card beside what the planner's preset has for the robot, None where there is none."""
    for group, robot in choices.items():
        config_group, _, package = group.partition("@")
        if config_group.startswith("planner/") and config_group.endswith(TUNING) and package == "planner":
            return _read_card(option_files(config_group, manager).get(robot), robot)
    return None


def _read_card(file: Traversable | None, preset: str) -> dict[str, Any] | None:
    """Return the card of a preset, None where there is none that can be read."""
    folder = getattr(file, "parent", None)
    if folder is None:
        return None
    try:
        content = json.loads((folder / f"{preset.rpartition('/')[2]}{CARD}").read_text(encoding="utf-8")[:LARGEST])
    except (OSError, ValueError):
        return None
    whole = isinstance(content, dict) and isinstance(content.get("values"), dict)
    return content if whole and isinstance(content.get("budget", {}), dict) else None


def _by_card(card: Mapping[str, Any], node: Mapping[str, Any]) -> str:
    told = f"by arena tune for {card.get('robot')}"
    changed = [key for key, value in card["values"].items() if _value(node, key) != value]
    return f"{told}, but for {', '.join(changed)}" if changed else told


def _value(node: Mapping[str, Any], key: str) -> Any:
    try:
        return value_at(node, key)
    except ConfigurationError:
        return None


def _without_card(preset: str, choices: Mapping[str, str], manager: PluginManager) -> str:
    """Return what is known of a preset without a card: one that repeats others' values says whose by its name."""
    if whose := _whose(preset):
        return whose
    asked = [(group.partition("@")[0], option) for group, option in choices.items() if "_tuning" in group]
    lacking = [option for group, option in asked if option not in option_files(group, manager)]
    return UNTUNED if lacking else BY_HAND


def _whose(preset: str) -> str:
    """Return whose values a preset repeats, by its name; empty where they are its own."""
    whose = preset.partition("_as_")[2]
    return f"as {whose.replace('_', ' ')}, no card" if whose else ""
