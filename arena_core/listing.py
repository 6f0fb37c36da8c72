"""``arena list``: what is installed, from which distribution, with every parameter, its default and its unit."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator, Sequence
from importlib.resources.abc import Traversable
from typing import Any, ClassVar

from arena_core.configuration import option_files
from arena_core.errors import UnknownComponent
from arena_core.interfaces import Command, Listing
from arena_core.registry import HOOKS, Registry, load_registry, unknown

KINDS = [kind for kind in HOOKS if kind != "listing"]
PARAMETER = re.compile(r"^(?P<indent> *)(?P<key>[A-Za-z_]\w*):\s*(?P<value>[^#]*?)\s*(#\s*(\[(?P<unit>[^\]]*)\])?\s*(?P<text>.*))?$")


class ListCommand(Command):
    """List what is installed."""

    help: ClassVar[str] = "what is installed: arena list [KIND] [--names]"

    def run(self, arguments: Sequence[str]) -> int:
        """Print all kinds in short, or one kind with the parameters of its presets."""
        parser = argparse.ArgumentParser("arena list", description=self.__doc__)
        parser.add_argument("kind", nargs="?", help=", ".join(KINDS))
        parser.add_argument("--names", action="store_true", help="print names alone, one a line")
        given = parser.parse_args(list(arguments))
        registry = load_registry()
        listings = registry.names("listing")
        if given.kind is not None and given.kind not in (*KINDS, *listings):
            raise UnknownComponent(unknown("kind", given.kind, [*KINDS, *listings]))
        for name in [given.kind] if given.kind else [*filter(registry.names, KINDS), *listings]:
            show = _print_kind if name in KINDS else _print_listing
            show(registry, name, detailed=given.kind is not None, names_only=given.names)
        return 0


def presets(registry: Registry, kind: str) -> dict[str, Traversable]:
    """Return the YAML file of every preset of a kind, by preset name."""
    return {name: file for name, file in option_files(kind, registry.manager).items() if "/" not in name}


def registered_name(preset: Traversable) -> str | None:
    """Return the component that a preset is a parameter set of."""
    match = re.search(r"^name:\s*(\S+)", preset.read_text(), re.M)
    return match.group(1) if match else None


def _print_kind(registry: Registry, kind: str, detailed: bool, names_only: bool) -> None:
    names = registry.names(kind)
    if names_only:
        print("\n".join(names))
        return
    files_of = presets(registry, kind)
    print(f"{kind}" if names else f"{kind}: none installed")
    for name in names:
        distribution, version = registry.component(kind, name).distribution()
        own = [preset for preset, file in files_of.items() if registered_name(file) == name]
        others = [preset for preset in own if preset != name]
        print(f"  {name:22} {distribution} {version}" + (f"   presets: {', '.join(others)}" if others else ""))
        if detailed:
            for preset in own:
                _print_parameters(preset, files_of[preset])


def _print_listing(registry: Registry, name: str, detailed: bool, names_only: bool) -> None:
    listing: Listing = registry.component("listing", name).resolve()()
    if names_only:
        print("\n".join(listing.names()))
        return
    print("\n  ".join([name, *(listing.details() if detailed else listing.summary())]))


def _print_parameters(preset: str, file: Traversable) -> None:
    print(f"    {preset}:")
    for key, value, unit, text in _parameters(file.read_text()):
        print(f"      {key:24} {value:>14} {unit:10} {text}".rstrip())


def _parameters(text: str) -> Iterator[tuple[str, Any, str, str]]:
    """Yield (key, default, unit, text) of every parameter line of a component's YAML."""
    for line in text.splitlines():
        match = PARAMETER.match(line)
        if match and match["key"] not in ("name", "defaults"):
            yield match["indent"] + match["key"], match["value"], match["unit"] or "", match["text"] or ""
