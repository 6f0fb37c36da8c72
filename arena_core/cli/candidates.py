"""What can come next on a command line: options of configuration groups and keys, read from their files
without composing anything.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from pluggy import PluginManager

from arena_core.cli.words import MARKS, key_value
from arena_core.config.configuration import PRIMARY
from arena_core.config.option_folders import group_names, option_files
from arena_core.config.plugins import load_plugins
from arena_core.config.presets import Parameter, Path, Preset, options_of, read_preset

TRUTHS = ("false", "true")


def complete_overrides(words: Sequence[str], word: str, primary: str = PRIMARY) -> list[str]:
    """Return what the override ``word`` can become after other words: `planner=dwa`, `timing.`, `planner.gain=`, up to
    the next dot.

    ``primary`` is the configuration that the command composes.
    """
    manager = load_plugins()
    settings = read_preset(primary, option_files("", manager))
    key, equals, value = word.partition("=")
    name = key.lstrip(MARKS)
    group = name.partition(".")[0]
    if equals and name in group_names(manager):
        begun = value[: max(value.rfind(","), value.rfind("[")) + 1]
        return [f"{key}={begun}{option}" for option in options_of(name, manager)]
    chosen = dict(map(key_value, words)).get(group) or settings.choices.get(group, "")
    keys = {**settings.parameters, **_option_keys(group, chosen, manager)}
    if equals:
        parameter = keys.get(tuple(name.split(".")))
        return [f"{key}={truth}" for truth in TRUTHS if parameter and parameter.value in TRUTHS]
    mark = key.removesuffix(name)
    return [mark + found for found in [*(f"{choice}=" for choice in settings.choices), *_next_keys(keys, name)]]


def _option_keys(group: str, chosen: str, manager: PluginManager) -> dict[Path, Parameter]:
    """Return the parameters of the chosen options of a group, by where they stand in the configuration."""
    files = option_files(group, manager)
    read = [(option, read_preset(option, files)) for option in re.split(r"[\[\],]+", chosen) if option in files]
    return {
        (*_group_path(group, preset), *path): parameter
        for _, preset in read
        for path, parameter in preset.parameters.items()
    }


def _group_path(group: str, preset: Preset) -> Path:
    return {"": (group,), "_global_": ()}.get(preset.package, tuple(preset.package.split(".")))


def _next_keys(keys: dict[Path, Parameter], name: str) -> list[str]:
    """Return the keys beside the last part of ``name``: with a dot where there are keys below,
    else with an equals sign.
    """
    *parents, _ = name.split(".")
    above = [path[: len(parents) + 1] for path in keys if path[: len(parents)] == tuple(parents)]
    below = {path[: len(parents) + 1] for path in keys if len(path) > len(parents) + 1}
    return sorted({".".join(path) + ("." if path in below else "=") for path in above if len(path) > len(parents)})
