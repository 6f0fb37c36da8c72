"""Presets derive from one another: a value has one home, and what was published stays as it was."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from hashlib import blake2b
from typing import Any

import pytest
import yaml

from arena_core.files import option_files
from arena_core.hosting import compose, load_registry, to_plain

GROUPS = (
    "planner",
    "robot",
    "world",
    "pedestrians",
    "task",
    "localizer",
    "global_planner",
    "waypoints",
    "local_map",
    "tracker",
    "reward",
    "observation_encoder",
    "metrics",
    "executor",
    "simulator",
    "recipe",
    "recipe_tuning",
    "people",
    "people_task",
    "people_crowd",
    "experiment",
    "world_model_tuning",
    "vision_tuning",
    "switch",
    "gait",
    "furniture",
)

# What others published, as it composes for a robot that no tuning is for. Whoever changes a preset that one of these
# derives from states the published value in the derived one; only a value that was wrong, a key's new name, or a new
# key that is without effect changes a digest.
PUBLISHED: Mapping[str, str] = {
    "planner/aio_as_released": "a811ff4932fa",
    "planner/dwa_as_released": "f72264a6e5b4",
    "planner/gring_as_released": "2be31169c178",
    "planner/mpc_as_released": "cebed9d9a86c",
    "planner/mppi_as_nav2": "6a9659d83d46",
    "planner/navrep_as_released": "ed92a47dcdc0",
    "planner/rosnav_as_paper": "e564cbc82990",
    "planner/teb_as_released": "90e84f096067",
    "planner/teb_in_aio_as_released": "90e84f096067",
    "localizer/amcl_as_clearpath": "0d14a2d440fe",
    "localizer/amcl_as_ros": "fc774aeb49f5",
    "pedestrians/social_force_as_released": "48999554a0ca",
}


@pytest.fixture(scope="module")
def options() -> dict[str, Any]:
    """Give the content of every option, by ``group/option``."""
    manager = load_registry().manager
    found = {f"{group}/{name}": file for group in GROUPS for name, file in option_files(group, manager).items()}
    return {name: yaml.safe_load(file.read_text()) or {} for name, file in found.items()}


def bases(name: str, options: Mapping[str, Any]) -> list[str]:
    """Return the options of the same group that an option takes its values from, in this order."""
    entries = [
        entry.partition("@")[0]
        for entry in options[name].get("defaults", [])
        if isinstance(entry, str) and entry != "_self_"
    ]
    group = name.rpartition("/")[0]
    return [f"{group}/{entry}" for entry in entries if f"{group}/{entry}" in options]


def inherited(name: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values, by their place, that an option takes from others."""
    values: dict[str, Any] = {}
    for base in bases(name, options):
        values |= inherited(base, options) | dict(leaves(options[base]))
    return values


def leaves(node: Mapping[str, Any], place: str = "") -> Iterator[tuple[str, Any]]:
    """Yield all values of an option but the component's name, each with its place."""
    for key, value in node.items():
        if isinstance(value, Mapping) and value:
            yield from leaves(value, f"{place}{key}.")
        elif place or key not in ("name", "defaults"):
            yield f"{place}{key}", value


def test_no_preset_repeats_a_value_of_its_base(options):
    repeated = []
    for name, content in options.items():
        base = inherited(name, options)
        repeated += [f"{name}: {place}" for place, value in leaves(content) if place in base and base[place] == value]
    assert repeated == []


def test_presets_of_one_component_derive_from_one_another(options):
    unrelated = []
    for group in {name.rpartition("/")[0] for name in options}:
        roots: dict[str, str] = {}
        for name, content in sorted(options.items()):
            if name.rpartition("/")[0] == group and "name" in content and not bases(name, options):
                other = roots.setdefault(content["name"], name)
                same = (
                    [p for p, v in leaves(content) if dict(leaves(options[other])).get(p, ()) == v]
                    if other != name
                    else []
                )
                unrelated += [f"{name} and {other} share {', '.join(same)}"] if len(same) > 2 else []
    assert unrelated == []


def composed(option: str) -> Any:
    group, _, name = option.partition("/")
    chosen = f"{group}=[{name}]" if group == "metrics" else f"{group}={name}"
    return to_plain(compose([chosen], "component"))[group]


def test_every_published_preset_has_its_digest(options):
    named = {
        name
        for name in options
        if "_as_" in name.rpartition("/")[2] and name.split("/")[0] in ("planner", "localizer", "pedestrians")
    }
    assert {name for name in named if name.count("/") == 1} == set(PUBLISHED)


@pytest.mark.parametrize("option", PUBLISHED)
def test_a_published_preset_stays_as_it_was_published(option):
    text = json.dumps(composed(option), sort_keys=True)
    assert blake2b(text.encode(), digest_size=6).hexdigest() == PUBLISHED[option]
