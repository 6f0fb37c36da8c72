"""The result of a tuning: a preset of a planner, or of a stack, and the card beside it that says how it came to be."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError
from arena_core.files import write_text_whole
from arena_core.hosting import SearchSpace

CARD = ".card.json"  # ending of a preset's card, beside its file
FORMAT, VERSION = "arena-tuning", 1


def preset_path(folder: Path, name: str) -> Path:
    """Return where a preset of a name lies in the folder of its group; raise ConfigurationError for what is no name."""
    if not name.replace("_", "").replace("-", "").isalnum():
        raise ConfigurationError(f"preset is {name}; allowed: letters, digits, _ and -")
    return folder / f"{name}.yaml"


def check_free(path: Path, card: str) -> None:
    """Raise ConfigurationError where a file is there already, unless a tuning with this ``card`` has written it."""
    beside = path.with_suffix(CARD)
    if path.exists() and not (beside.exists() and json.loads(beside.read_text()).get("settings") == card):
        raise ConfigurationError(f"{path} is there already; allowed: preset=NAME, another name")


def write_preset(path: Path, card: Mapping[str, Any], space: SearchSpace) -> None:
    """Write the preset and its card."""
    comments = {key: f"[{one.unit}] {one.why} (tuned)" for key, one in space.parameters.items()}
    head = _stack_lines if "parts" in card else _planner_lines
    lines = [*head(card, path.with_suffix(CARD).name), *_nested_lines({**card["fixed"], **card["values"]}, comments)]
    write_text_whole(path, "\n".join(lines) + "\n")
    write_card(path.with_suffix(CARD), card)


def _planner_lines(card: Mapping[str, Any], beside: str) -> list[str]:
    return [
        f"# {card['planner']} for {card['robot']}, tuned by `arena tune`; {beside} says how.",
        "defaults:",
        f"  - {card['preset']}",
        "  - _self_",
        f"name: {card['planner']}",
    ]


def _stack_lines(card: Mapping[str, Any], beside: str) -> list[str]:
    """Return the lines that choose the parts of a stack, so that values meet what they are of."""
    return [
        "# @package _global_",
        f"# What guides a planner on {card['robot']}, tuned by `arena tune stack` with {card['planner']}; "
        f"{beside} says how.",
        "defaults:",
        *(f"  - override /{part}: {option}" for part, option in card["parts"].items()),
        "  - _self_",
    ]


def write_card(path: Path, card: Mapping[str, Any]) -> None:
    """Write a card, whole or not at all."""
    write_text_whole(path, json.dumps({"format": FORMAT, "version": VERSION, **card}, indent=1) + "\n")


def _nested_lines(values: Mapping[str, Any], comments: Mapping[str, str]) -> list[str]:
    """Return the lines of a mapping of keys with dots, nested; each value has its comment."""
    tree: dict[str, Any] = {}
    for key, value in values.items():
        *place, name = key.split(".")
        inside = tree
        for part in place:
            inside = inside.setdefault(part, {})
        inside[name] = f"{json.dumps(value)}  # {comments.get(key, 'as it was given')}"
    return _lines_of(tree, "")


def _lines_of(tree: Mapping[str, Any], indent: str) -> list[str]:
    found = []
    for key, value in tree.items():
        if isinstance(value, dict):
            found += [f"{indent}{key}:", *_lines_of(value, f"{indent}  ")]
        else:
            found.append(f"{indent}{key}: {value}")
    return found
