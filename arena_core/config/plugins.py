"""Find and load the installed plugins: everything in the entry-point group ``arena``, in order of name."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from functools import lru_cache
from importlib.metadata import EntryPoint, entry_points
from importlib.resources import files

import pluggy

from arena_core.base.errors import BrokenPlugin, describe_error
from arena_core.contracts import hookspecs

GROUP = "arena"
DISABLED = "ARENA_DISABLED_PLUGINS"


def load_plugins() -> pluggy.PluginManager:
    """Return a manager with every installed plugin that ``ARENA_DISABLED_PLUGINS`` does not name.

    It is made once: what is installed meanwhile changes nothing. Raises BrokenPlugin when a plugin cannot be imported,
    misspells a hook or declares wrong arguments.
    """
    return _load_manager(os.environ.get(DISABLED, ""), tuple(sys.path))


@lru_cache(maxsize=1)
def _load_manager(disabled: str, path: tuple[str, ...]) -> pluggy.PluginManager:
    manager = pluggy.PluginManager(GROUP)
    manager.add_hookspecs(hookspecs)
    for entry_point in enabled_entry_points():
        _register_plugin(manager, entry_point)
    try:
        manager.check_pending()
    except pluggy.PluginValidationError as error:
        raise broken_plugin(str(getattr(error.plugin, "__name__", error.plugin)), error) from error
    return manager


def enabled_entry_points() -> list[EntryPoint]:
    """Return the entry points of the plugins that are not switched off, sorted by name."""
    disabled = {name.strip() for name in os.environ.get(DISABLED, "").split(",")}
    return [point for point in _installed_entry_points(_search_path()) if point.name not in disabled]


@lru_cache(maxsize=1)
def _installed_entry_points(places: tuple[tuple[str, int], ...]) -> list[EntryPoint]:
    return sorted(entry_points(group=GROUP), key=lambda point: point.name)


def _search_path() -> tuple[tuple[str, int], ...]:
    """Return the folders of the path, each with when something was last installed in it, ns; 0 where there is none."""
    return tuple((place, _modified_at(place)) for place in sys.path)


def _modified_at(place: str) -> int:
    try:
        return os.stat(place or ".").st_mtime_ns
    except OSError:
        return 0


def plugin_distributions() -> dict[str, tuple[str, str]]:
    """Return name and version of the distribution that brought each plugin, switched off ones among them."""
    return _read_distributions(_search_path())


@lru_cache(maxsize=1)
def _read_distributions(places: tuple[tuple[str, int], ...]) -> dict[str, tuple[str, str]]:
    brought = {point.name: point.dist for point in _installed_entry_points(places) if point.dist}
    metadata = {found: found.metadata for found in set(brought.values())}
    return {plugin: (metadata[found]["Name"], metadata[found]["Version"]) for plugin, found in brought.items()}


def config_packages(manager: pluggy.PluginManager) -> dict[str, str]:
    """Return the configuration package of each plugin that has one, by plugin name."""
    implementations: Iterable[pluggy.HookImpl] = manager.hook.config_package.get_hookimpls()
    return dict(sorted((i.plugin_name, _config_package(i)) for i in implementations))


def broken_plugin(name: str, error: BaseException) -> BrokenPlugin:
    """Return the error for a plugin that failed, with the reason and how to switch it off."""
    said = str(error) if isinstance(error, Exception) else describe_error(error)
    reason = " ".join(said.split()) or type(error).__name__
    return BrokenPlugin(f"plugin {name} cannot be loaded ({reason}); mend it, or switch it off with {DISABLED}={name}")


def _register_plugin(manager: pluggy.PluginManager, entry_point: EntryPoint) -> None:
    try:
        manager.register(entry_point.load(), name=entry_point.name)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # sys.exit() of a module, too
        raise broken_plugin(entry_point.name, error) from error


def _config_package(implementation: pluggy.HookImpl) -> str:
    try:
        package = str(implementation.function())
        files(package)
    except Exception as error:
        raise broken_plugin(implementation.plugin_name, error) from error
    return package
