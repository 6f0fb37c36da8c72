"""Compose the configuration, and say in one line why it cannot be composed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from traceback import walk_tb
from typing import TYPE_CHECKING, Any

from arena_core.base.errors import ArenaError, ConfigurationError
from arena_core.base.files import reason_of
from arena_core.base.hints import did_you_mean, keys_below
from arena_core.base.suite import distribution_hint
from arena_core.config.option_folders import conf_directory
from arena_core.config.plugins import load_plugins
from arena_core.config.presets import options_of
from arena_core.config.registry import unknown_name

if TYPE_CHECKING:
    from omegaconf import DictConfig

PRIMARY = "config"
# options of Hydra that are packages of their own
EXTRAS = {"hydra/launcher/joblib": "joblib"}


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
        asking = re.match(r"In '([^']+)'", text)
        return _missing_option(error.missing_cfg_file or "", error.options, asking[1] if asking else "")
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


def _missing_option(file: str, options: Sequence[str] | None, asking: str = "") -> str:
    """Return the line for an option that no configuration source has; Hydra does not always say which there are.

    ``asking`` is the option, as ``group/option``, that names it as its base.
    """
    group, _, option = file.partition("/")
    known = [name for name in options_of(group, load_plugins()) if "/" not in name] or list(options or ())
    if asking.startswith(f"{group}/") and (brought := distribution_hint(group, option)):
        return f"{asking.replace('/', ' ', 1)} needs {brought.removeprefix('comes with ')}"
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
