"""Which code takes part in a cell: digests of the core, of every plugin that its configuration
chooses, and of what these share.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from hashlib import blake2b
from importlib.metadata import Distribution, EntryPoint, PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from arena_core.config.plugins import GROUP, enabled_entry_points
from arena_core.config.registry import HOOKS, Registry

CORE = "arena-core"
SUITE = "arena-"  # packages of ours that plugins share are called so
# kinds that have no part in how an episode goes
APART = ("metrics", "executor", "command", "listing", "reward", "trainer", "reference")
# a package's options: what an episode reads of them is in the composed configuration, which has a hash of its own
CONFIGURATION = "conf"
LEFT_OUT = (".pyc", ".pyo", ".nbi", ".nbc")  # what Python and numba compile on the way


@dataclass(frozen=True, slots=True)
class Code:
    """The code of a cell: its digest, eight hexadecimal digits, and "version content" of each
    distribution that takes part.
    """

    digest: str
    parts: Mapping[str, str]

    def changed(self, before: Mapping[str, str]) -> list[str]:
        """Return the distributions that are not as they were."""
        return sorted(name for name in {**before, **self.parts} if before.get(name) != self.parts.get(name))


def digest_code(
    config: Mapping[str, Any], registry: Registry, apart: Sequence[str] = APART, besides: Iterable[str] = ()
) -> Code:
    """Return the code that a composed configuration runs with, as it lies on the disk when this process first asks.

    Components of the kinds ``apart`` do not count; the plugins ``besides``, entry points by name, do in any case.
    """
    chosen = {
        registry.component(kind, name).plugin for kind, name in _configured_components(config, registry, apart)
    } | set(besides)
    return _digest_code(frozenset(point for point in enabled_entry_points() if point.name in chosen and point.dist))


@lru_cache(maxsize=64)
def _digest_code(brought: frozenset[EntryPoint]) -> Code:
    names = {_distribution_name(point.dist) for point in brought if point.dist}
    parts = {name: f"{dist.version} {content}" for name, dist, content in _digest_distributions({CORE, *names})}
    digest = blake2b(json.dumps(parts, sort_keys=True).encode(), digest_size=4).hexdigest()
    return Code(digest, parts)


def _configured_components(
    config: Mapping[str, Any], registry: Registry, apart: Sequence[str]
) -> Iterator[tuple[str, str]]:
    """Yield kind and name of every component that the configuration builds, also inside others (a switch's members)."""
    kinds = [kind for kind in HOOKS if kind not in apart]
    for key, node in config.items():
        if key not in apart and (names := set(_component_names(node))):
            yield from ((kind, name) for kind in kinds for name in registry.names(kind) if name in names)


def _component_names(node: Any) -> Iterator[str]:
    if isinstance(node, Mapping):
        name = node.get("name")
        if isinstance(name, str):
            yield name
            yield from (f"{name}/{value}" for value in node.values() if isinstance(value, str))  # a planner's policies
        for value in node.values():
            yield from _component_names(value)


def _digest_distributions(wanted: Iterable[str]) -> Iterator[tuple[str, Distribution, str]]:
    """Yield name, distribution and content of these distributions and of what they need of the suite or of
    the user's own checkouts.
    """
    plugins = {_distribution_name(point.dist) for point in enabled_entry_points() if point.dist}
    open_names, seen = sorted(wanted), set(wanted)
    while open_names:
        name = open_names.pop()
        try:
            found = distribution(name)
        except PackageNotFoundError:
            continue  # imported from a folder that no one installed
        yield name, found, _digest_content(found)
        needed = {
            other
            for other in _required_names(found)
            if other in plugins or other.startswith(SUITE) or _is_editable(other)
        }
        open_names += sorted(needed - seen)
        seen |= needed


def _required_names(found: Distribution) -> set[str]:
    """Return the distributions that one requires without any extra."""
    lines = [line for line in found.requires or [] if "extra ==" not in line]
    return {_normal_name(match[0]) for line in lines if (match := re.match(r"[A-Za-z0-9._-]+", line))}


def _is_editable(name: str) -> bool:
    try:
        text = distribution(name).read_text("direct_url.json") or "{}"
        return bool(json.loads(text).get("dir_info", {}).get("editable"))
    except (PackageNotFoundError, ValueError):
        return False


def _digest_content(found: Distribution) -> str:
    """Return a digest of the files of a distribution's packages: those of its
    plugins, and the one that bears its name.
    """
    points = {point.module.partition(".")[0] for point in found.entry_points if point.group == GROUP}
    roots = sorted(
        {root for module in {*points, _distribution_name(found).replace("-", "_")} for root in _package_roots(module)}
    )
    digest = blake2b(digest_size=4)
    for root in roots:
        for path in _source_files(root):
            digest.update(f"{path.relative_to(root.parent).as_posix()}\0".encode())
            digest.update(blake2b(_without_line_endings(path.read_bytes())).digest())
    return digest.hexdigest()


def _package_roots(module: str) -> list[Path]:
    """Return the folders of a package, or the file of a module; nothing where it cannot be found."""
    spec = find_spec(module)
    if spec is None:
        return []
    if spec.submodule_search_locations is not None:
        return [Path(place) for place in spec.submodule_search_locations]
    return [Path(spec.origin)] if spec.origin else []


def _source_files(root: Path) -> list[Path]:
    if root.is_file():
        return [root]
    found = [path for path in root.rglob("*") if path.is_file() and path.suffix not in LEFT_OUT]
    return sorted(path for path in found if not _is_apart(path.relative_to(root).parts))


def _is_apart(parts: tuple[str, ...]) -> bool:
    return parts[0] == CONFIGURATION or any(part == "__pycache__" or part.startswith(".") for part in parts)


def _without_line_endings(content: bytes) -> bytes:
    """Return texts with the line endings of Unix, so that a checkout on Windows is the same
    code; other files as they are.
    """
    return content if b"\0" in content else content.replace(b"\r\n", b"\n")


def _distribution_name(found: Distribution) -> str:
    return _normal_name(found.metadata["Name"])


def _normal_name(name: str) -> str:
    """Return a distribution's name as PEP 503 writes it."""
    return re.sub(r"[-_.]+", "-", name).lower()
