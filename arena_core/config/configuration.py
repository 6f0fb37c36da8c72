"""Compose the configuration: the core's tree, every plugin's groups, and the user's own ``conf`` folder."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from traceback import walk_tb
from typing import TYPE_CHECKING, Any

from arena_core.base.errors import ArenaError, ConfigurationError, DuplicateComponent
from arena_core.base.files import reason_of
from arena_core.base.hints import did_you_mean, keys_below
from arena_core.base.suite import distribution_hint
from arena_core.config.plugins import config_packages, load_plugins
from arena_core.config.registry import unknown_name

if TYPE_CHECKING:
    from omegaconf import DictConfig
    from pluggy import PluginManager

PRIMARY = "config"
# options of Hydra that are packages of their own
EXTRAS = {"hydra/launcher/joblib": "joblib", "hydra/sweeper/optuna": "optuna"}
DEEPEST = 3  # groups within groups: planner/base/small is an option of the second


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
    sources = [(plugin, _package_address(package)) for plugin, package in config_packages(manager).items()]
    own = own_folder()
    return [*sources, ("working-directory", f"arena://{own}")] if own else sources


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


def compose(overrides: Sequence[str] = (), config_name: str = PRIMARY, *, hydra: bool = False) -> DictConfig:
    """Return the configuration that ``arena run OVERRIDES`` would use; also from inside a Hydra application.

    With ``hydra`` it has Hydra's own node too: folders, and which option of each group was chosen.
    Raises ConfigurationError (one line) for an unknown option, key or value.
    """
    from hydra import compose as hydra_compose
    from hydra import initialize_config_dir
    from hydra.core.global_hydra import GlobalHydra

    previous = GlobalHydra.instance().hydra
    GlobalHydra.instance().clear()
    try:
        with one_line_errors(), initialize_config_dir(str(conf_directory()), job_name="arena", version_base="1.3"):
            return hydra_compose(config_name, overrides=list(overrides), return_hydra_config=hydra)
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
    except Exception as error:
        if bad := _bad_file(error):
            raise ConfigurationError(bad) from error
        # Hydra's word for planner=null and planner=3
        if not isinstance(error, ValueError) or "Config group override" not in str(error):
            raise
        raise ConfigurationError("an override chooses no component; allowed: KIND=NAME, such as planner=dwa") from error


def to_plain(config: Any) -> dict[str, Any]:
    """Return a composed configuration as plain, resolved containers; one that is plain already as it is."""
    from omegaconf import OmegaConf

    if isinstance(config, dict):
        return config
    with one_line_errors():
        container = OmegaConf.to_container(config, resolve=True, throw_on_missing=True)
    return container  # type: ignore[return-value]


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


def _bad_file(error: Exception) -> str:
    """Return the line for an error that PyYAML raised on a configuration file, whatever its
    class; empty for all others.
    """
    frames = [frame for frame, _ in walk_tb(error.__traceback__)]
    if not any(str(frame.f_globals.get("__name__")).startswith("yaml.") for frame in frames):
        return ""
    # as Hydra's sources call it
    named = [str(frame.f_locals["config_path"]) for frame in frames if "config_path" in frame.f_locals]
    mark = getattr(error, "problem_mark", None)
    place = f"line {mark.line + 1}: " if mark is not None else ""
    file = named[-1] if named else "a configuration file"
    return f"{file}: is no YAML ({place}{reason_of(error)}); allowed: a mapping of keys and values"


def _one_line(error: BaseException) -> str:
    from hydra.errors import MissingConfigException, OverrideParseException

    text = str(error)
    if isinstance(error, MissingConfigException):
        return _missing_option(error.missing_cfg_file or "", error.options)
    if isinstance(error, OverrideParseException):
        reason = _join_lines(text.splitlines()[0])
        return (
            f"{error.override} cannot be read: {reason}; allowed: KEY=VALUE, lists as [a,b], "
            "texts with spaces in quotes"
        )
    override = re.search(r"Could not override '([^']+)'", text)
    if override:
        cause = error.__cause__
        return _no_key(getattr(cause, "full_key", None) or override.group(1), getattr(cause, "parent_node", None))
    return _join_lines(f"{text} {error.__cause__ or ''}")


def _missing_option(file: str, options: Sequence[str] | None) -> str:
    """Return the line for an option that no configuration source has; Hydra does not always say which there are."""
    group, _, option = file.partition("/")
    known = list(options or option_files(group, load_plugins()))
    if extra := EXTRAS.get(file):
        return f"{'='.join(file.rsplit('/', 1))} comes with the extra arena-core[{extra}], which is not installed"
    return (
        unknown_name(group, option, known)
        if known or distribution_hint(group, option)
        else f"there is no {file}; `arena list` shows what is installed"
    )


def _join_lines(text: str) -> str:
    return re.sub(r"\s+", " ", text).strip()


def _no_key(key: str, parent: Any) -> str:
    """Return the line for a key that the configuration lacks, with what may be meant, here or deeper, and
    all that stand beside it.
    """
    from omegaconf import OmegaConf

    place, _, name = key.rpartition(".")
    inside: Any = OmegaConf.to_container(parent) if isinstance(parent, Mapping) else {}
    there = {str(name): value for name, value in inside.items() if name != "hydra"}
    hint = did_you_mean(name, sorted(there), keys_below(there))
    return f"{place or 'the configuration'} has no key {name}{hint} (possible: {', '.join(sorted(there)) or 'none'})"
