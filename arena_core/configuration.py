"""Compose the configuration: the core's tree, every plugin's groups, and the user's own ``conf`` folder."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from arena_core.errors import ArenaError, ConfigurationError, DuplicateComponent
from arena_core.plugins import config_packages, load_plugins

if TYPE_CHECKING:
    from omegaconf import DictConfig

PRIMARY = "config"


def conf_directory() -> Path:
    """Return the folder of the core's configuration tree: beside the package in a checkout, inside it in a wheel."""
    package = Path(__file__).resolve().parent
    inside = package / "conf"
    return inside if inside.is_dir() else package.parent / "conf"


def search_path() -> list[tuple[str, str]]:
    """Return (provider, path) of every configuration source after the core's own.

    Raises DuplicateComponent when two plugins offer the same option: Hydra would silently take the first.
    """
    packages = config_packages(load_plugins())
    offered: dict[str, str] = {}
    for plugin, package in packages.items():
        for option in _options(files(package)):
            if option in offered:
                raise DuplicateComponent(f"option {option} is offered by two plugins: {offered[option]} and {plugin}")
            offered[option] = plugin
    sources = [(plugin, f"pkg://{package}") for plugin, package in packages.items()]
    own = Path.cwd() / "conf"
    if own.is_dir() and own.resolve() != conf_directory().resolve():
        sources.append(("working-directory", own.as_uri()))
    return sources


def compose(overrides: Sequence[str] = (), config_name: str = PRIMARY) -> DictConfig:
    """Return the configuration that ``arena run OVERRIDES`` would use; also from inside a Hydra application.

    Raises ConfigurationError (one line) for an unknown option, key or value.
    """
    from hydra import compose as hydra_compose
    from hydra import initialize_config_dir
    from hydra.core.global_hydra import GlobalHydra

    previous = GlobalHydra.instance().hydra
    GlobalHydra.instance().clear()
    try:
        with one_line_errors(), initialize_config_dir(str(conf_directory()), job_name="arena", version_base="1.3"):
            return hydra_compose(config_name, overrides=list(overrides))
    finally:
        GlobalHydra.instance().hydra = previous


@contextmanager
def one_line_errors() -> Iterator[None]:
    """Turn Hydra's and OmegaConf's errors into a ConfigurationError of one line."""
    from hydra.errors import HydraException
    from omegaconf.errors import OmegaConfBaseException

    try:
        yield
    except (HydraException, OmegaConfBaseException) as error:
        chain = [error, error.__cause__, error.__context__]
        own = next((e for e in chain if isinstance(e, ArenaError)), None)
        raise own or ConfigurationError(_one_line(error)) from error


def plain(config: Any) -> dict[str, Any]:
    """Return a composed configuration as plain, resolved containers."""
    from omegaconf import OmegaConf

    with one_line_errors():
        container = OmegaConf.to_container(config, resolve=True, throw_on_missing=True)
    return container  # type: ignore[return-value]


def _options(folder: Traversable, group: str = "") -> Iterator[str]:
    for entry in folder.iterdir():
        if entry.is_dir() and not entry.name.startswith("_"):
            yield from _options(entry, f"{group}{entry.name}/")
        elif entry.name.endswith(".yaml"):
            yield f"{group}{entry.name.removesuffix('.yaml')}"


def _one_line(error: BaseException) -> str:
    text = str(error)
    missing = re.search(r"Could not find '([^']+)/([^'/]+)'.*?Available options in '[^']+':\s*(.*?)(?:\nConfig search path|\Z)", text, re.S)
    if missing:
        group, option, available = missing.groups()
        return f"unknown {group} {option!r} (possible: {', '.join(available.split())})"
    nothing = re.search(r"Could not find '([^']+)'", text)
    if nothing:
        return f"there is no {nothing.group(1)}; `arena list` shows what is installed"
    override = re.search(r"Could not override '([^']+)'", text)
    if override:
        return f"{override.group(1)} is no key of the configuration{_siblings(override.group(1))}"
    cause = error.__cause__
    lines = [line for line in (text, str(cause) if cause else "") if line]
    return re.sub(r"\s+", " ", " ".join(lines)).strip()


def _siblings(key: str) -> str:
    """Return the keys that stand where ``key`` was looked for, if the defaults tell."""
    parent = key.rpartition(".")[0]
    return f"; `arena list {parent.split('.')[0]}` shows the parameters" if parent else "; `arena list` shows what there is"
