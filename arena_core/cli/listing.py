"""``arena list``: what is installed, from which distribution, with every parameter, its default and its unit."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from importlib.resources.abc import Traversable
from typing import ClassVar

from arena_core.base.errors import UnknownComponent
from arena_core.config.option_folders import group_names, option_files
from arena_core.config.plugins import plugin_distributions
from arena_core.config.presets import TUNING, Preset, options_of, read_preset
from arena_core.config.registry import HOOKS, Registry, load_registry, unknown_name
from arena_core.contracts.running import Command, Listing
from arena_core.runs.text_columns import align_columns

KINDS = [kind for kind in HOOKS if kind != "listing"]
PRESET = "preset"  # what lists the options of all groups
WIDEST = 16  # characters of a value that the column makes room for


class ListCommand(Command):
    """List what is installed."""

    help: ClassVar[str] = "what is installed: arena list [KIND|experiment|preset] [--names]"

    def run(self, arguments: Sequence[str]) -> int:
        """Print all kinds in short, one kind with the parameters of its presets, or the options
        of a configuration group.
        """
        registry = load_registry()
        listable = listed_kinds(registry)
        parser = argparse.ArgumentParser("arena list", description=self.__doc__)
        parser.add_argument("kind", nargs="?", help=", ".join(listable))
        parser.add_argument("--names", action="store_true", help="print names alone, one a line")
        given = parser.parse_args(list(arguments))
        if given.kind not in (None, *listable):
            raise UnknownComponent(unknown_name("kind", given.kind, listable))
        chosen = [given.kind] if given.kind else [*filter(registry.names, KINDS), *registry.names("listing")]
        show = _listed_names if given.names else _kind_details if given.kind else _kind_summary
        for kind in chosen:
            print("\n".join(show(registry, kind)))
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return what can be listed."""
        return ["--names"] if word.startswith("-") else listed_kinds(load_registry()) if not words else []


def listed_kinds(registry: Registry) -> list[str]:
    """Return what can be listed: kinds of components, listings of plugins, all other configuration groups,
    and all options together.
    """
    others = [group for group in group_names(registry.manager) if group not in KINDS and not group.endswith(TUNING)]
    listings = registry.names("listing")
    return [*KINDS, *listings, *(group for group in others if group not in listings), PRESET]


def preset_files(registry: Registry, kind: str) -> dict[str, Traversable]:
    """Return the YAML file of every preset of a kind, by preset name."""
    return {name: file for name, file in options_of(kind, registry.manager).items() if "/" not in name}


def _kind_summary(registry: Registry, kind: str) -> list[str]:
    """Return what `arena list` says of a kind."""
    if kind in KINDS:
        return [kind, *_component_lines(registry, kind)]
    return [kind, *(f"  {line}" for line in _find_listing(registry, kind).summary())]


def _listed_names(registry: Registry, kind: str) -> Sequence[str]:
    if kind in KINDS:
        return registry.names(kind)
    if kind in registry.names("listing"):
        return _find_listing(registry, kind).names()
    return [f"{group}={option}" if kind == PRESET else option for group, option, _ in _option_rows(registry, kind)]


def _kind_details(registry: Registry, kind: str) -> list[str]:
    """Return the lines about one kind alone."""
    if kind in registry.names("listing"):
        return [kind, *(f"  {line}" for line in _find_listing(registry, kind).details())]
    if kind not in KINDS:
        return align_columns([(f"{group}={option}", about) for group, option, about in _option_rows(registry, kind)])
    if not registry.names(kind):
        return [f"{kind}: none installed"]
    files = preset_files(registry, kind)
    every = option_files(kind, registry.manager)  # with those of subgroups, which others derive from
    read = {option: read_preset(option, every) for option in files}
    lines = [kind]
    for name, line in zip(registry.names(kind), _component_lines(registry, kind), strict=True):
        own = [option for option, preset in read.items() if preset.component == name]
        lines += [line, *(text for option in own for text in _preset_lines(option, read[option]))]
    return lines


def _component_lines(registry: Registry, kind: str) -> list[str]:
    """Return a line for each component of a kind, in order: its name, its
    distribution, and its presets of other names.
    """
    files, brought = preset_files(registry, kind), plugin_distributions()
    named = {option: read_preset(option, files).component for option in files}
    rows = []
    for name in registry.names(kind):
        plugin = registry.component(kind, name).plugin
        others = [option for option, component in named.items() if component == name and option != name]
        source = " ".join(brought.get(plugin, (plugin, "-")))
        rows.append((f"  {name:20}", source, f"presets: {', '.join(others)}" if others else ""))
    return align_columns(rows)


def _preset_lines(option: str, preset: Preset) -> list[str]:
    """Return what a preset is, and its parameters."""
    rows = [("  " * len(p.path) + p.path[-1], p.value, p.unit, p.text) for p in preset.parameters.values()]
    return [
        f"    {option}: {preset.about}".rstrip(" "),
        *(f"    {line}" for line in align_columns(rows, right=[1], widest=WIDEST)),
    ]


def _option_rows(registry: Registry, kind: str) -> Iterator[tuple[str, str, str]]:
    """Yield group, name and first line of comment of every option of a group, or of all groups,
    without tunings for robots.
    """
    for group in group_names(registry.manager) if kind == PRESET else [kind]:
        files = options_of(group, registry.manager)
        yield from ((group, option, read_preset(option, files).about) for option in files)


def _find_listing(registry: Registry, name: str) -> Listing:
    listing: Listing = registry.component("listing", name).resolve()()
    return listing
