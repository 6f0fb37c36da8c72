"""The folders of configuration groups, and the options in them: the core's tree, every plugin's, and the user's own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import TYPE_CHECKING

from arena_core.base.errors import DuplicateComponent
from arena_core.config.plugins import config_packages, load_plugins

if TYPE_CHECKING:
    from pluggy import PluginManager

DEEPEST = 3  # groups within groups: planner/base/small is an option of the second
RENAMED = "_renamed"  # the folder of a configuration package that holds options of former names


def conf_directory() -> Path:
    """Return the folder of the core's configuration tree: beside the package in a checkout, inside it in a wheel."""
    package = Path(__file__).resolve().parents[1]
    inside = package / "conf"
    return inside if inside.is_dir() else package.parent / "conf"


def search_path() -> list[tuple[str, str]]:
    """Return (provider, path) of every configuration source after the core's own.

    Raises DuplicateComponent when two sources offer the same option of a group: Hydra would silently take the first.
    """
    manager = load_plugins()
    _check_options(_group_folders(manager))
    packages = config_packages(manager)
    sources = [(plugin, _package_address(package)) for plugin, package in packages.items()]
    own = own_folder()
    sources += [("working-directory", f"arena://{own}")] if own else []
    return [*sources, *_renamed_options(packages)]


def _renamed_options(packages: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield the sources of former names, which are looked at where no option has the name now."""
    for plugin, package in packages.items():
        folder = files(package) / RENAMED
        if isinstance(folder, Path) and folder.is_dir():
            yield f"{plugin}-renamed", f"arena://{folder}"


def _package_address(package: str) -> str:
    """Return where Hydra finds a configuration package: its folder, where it is one (an archive has none)."""
    folder = files(package)
    return f"arena://{folder}" if isinstance(folder, Path) else f"pkg://{package}"


def option_files(group: str, manager: PluginManager) -> dict[str, Traversable]:
    """Return the file of every option of a group, by the option's name; those of subgroups are
    called ``subgroup/option``.
    """
    folders = [folder / group for folder in _group_folders(manager).values()]
    return dict(
        sorted(
            (name, folder / f"{name}.yaml") for folder in folders if folder.is_dir() for name in _option_names(folder)
        )
    )


def group_names(manager: PluginManager) -> list[str]:
    """Return the configuration groups, sorted; without Hydra's own."""
    entries = [entry for folder in _group_folders(manager).values() for entry in folder.iterdir() if entry.is_dir()]
    return sorted({entry.name for entry in entries if not entry.name.startswith("_")} - {"hydra"})


def _group_folders(manager: PluginManager) -> dict[str, Traversable]:
    """Return every folder of configuration groups, by who offers it."""
    folders: dict[str, Traversable] = {"the core": conf_directory()}
    folders |= {f"plugin {plugin}": files(package) for plugin, package in config_packages(manager).items()}
    own = own_folder()
    return {**folders, f"your folder {own}": own} if own else folders


def own_folder() -> Path | None:
    """Return the user's own configuration folder, ``conf`` where they are; None where there is none."""
    own = Path.cwd() / "conf"
    return own if own.is_dir() and own.resolve() != conf_directory().resolve() else None


def _check_options(folders: Mapping[str, Traversable]) -> None:
    """Raise DuplicateComponent when two folders hold the same option of a group."""
    offered: dict[str, str] = {}
    for source, folder in folders.items():
        for option in _option_names(folder):
            if "/" in option and option in offered:
                raise DuplicateComponent(
                    f"option {option} is offered twice: by {offered[option]} and by {source}; rename one"
                )
            offered[option] = source


def _option_names(folder: Traversable, group: str = "") -> Iterator[str]:
    """Yield the options below a folder; folders that cannot be read, deeper ones and links in a
    circle or upwards hold none.
    """
    try:
        entries = [(entry, entry.is_dir()) for entry in folder.iterdir()]
    except OSError:
        return
    for entry, is_folder in entries:
        if is_folder and not entry.name.startswith("_"):
            if group.count("/") < DEEPEST and not _leads_up(entry, folder):
                yield from _option_names(entry, f"{group}{entry.name}/")
        elif not is_folder and entry.name.endswith(".yaml"):
            yield f"{group}{entry.name.removesuffix('.yaml')}"


def _leads_up(entry: Traversable, folder: Traversable) -> bool:
    """Return whether a folder is a link to one that it lies in itself."""
    return (
        isinstance(entry, Path)
        and isinstance(folder, Path)
        and entry.is_symlink()
        and folder.resolve().is_relative_to(entry.resolve())
    )
