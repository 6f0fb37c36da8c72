"""The words of a multirun: its jobs, and what Hydra is told of words that fit its jobs alone."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

from arena_core.base.errors import ConfigurationError
from arena_core.config.configuration import PRIMARY
from arena_core.config.option_folders import conf_directory

if TYPE_CHECKING:
    from hydra.core.config_loader import ConfigLoader
    from hydra.core.override_parser.types import Override


def expand_sweep(words: Sequence[str]) -> list[list[str]]:
    """Return the overrides of every job: one for each combination of swept values, the last word of each key.

    Raises ConfigurationError for an interval, which has no end of values, and Hydra's own errors.
    """
    choices = {one.get_key_element(): _key_choices(one) for one in _parse_overrides(words)}
    return [list(job) for job in product(*choices.values())]


def are_swept(words: Sequence[str]) -> bool:
    """Return whether a word sweeps over values; raise Hydra's own error for one that cannot be read."""
    return any(one.is_sweep_override() for one in _parse_overrides(words))


def _key_choices(one: Override) -> list[str]:
    key = one.get_key_element()
    if not one.is_sweep_override():
        return [f"{key}={one.get_value_element_as_str()}"]
    if not one.is_discrete_sweep():
        raise ConfigurationError(
            f"{one.input_line} has no end of values; allowed: {key}=A,B,C, or hydra/sweeper=optuna"
        )
    return [f"{key}={value}" for value in one.sweep_string_iterator()]


def defer_job_overrides(words: Sequence[str], *, multirun: bool) -> list[str]:
    """Return the words of a multirun, those that only its jobs can take as sweeps of one value: Hydra leaves sweeps to
    the jobs.

    ``world=indoor,outdoor world.difficulty=0.4`` is such a case: what all jobs have in common has the default world,
    without that key. Where a default is not installed, what all jobs have in common has the first of the swept options.
    Words stay as they are where Hydra's own options stand among them, and where neither ``multirun`` nor an experiment
    makes a multirun.
    """
    from hydra import initialize_config_dir
    from hydra.core.global_hydra import GlobalHydra
    from hydra.errors import MissingConfigException
    from hydra.types import RunMode

    if any(word.startswith("-") for word in words):
        return list(words)
    with initialize_config_dir(str(conf_directory()), job_name="arena", version_base="1.3"):
        loader = GlobalHydra.instance().config_loader()
        settings = {one.input_line: one for one in _parse_overrides(words) if not _is_group_choice(one, loader)}
        try:
            common = _load_common(loader, [word for word in words if word not in settings])
        except MissingConfigException:
            chosen, told = _choose_first_options(words, loader)
            common = _load_common(loader, [word for word in chosen if word not in settings])
            if "first_options" not in common.hydra.sweeper:  # that of another package
                return list(words)
            words = [*chosen, *told]
        if not multirun and common.hydra.mode is not RunMode.MULTIRUN:
            return list(words)
        return [
            _as_choice_sweep(settings[word]) if word in settings and not _fits_common(settings[word], common) else word
            for word in words
        ]


def _load_common(loader: ConfigLoader, words: list[str]) -> Any:
    from hydra.types import RunMode

    return loader.load_configuration(PRIMARY, words, RunMode.MULTIRUN)


def _choose_first_options(words: Sequence[str], loader: ConfigLoader) -> tuple[list[str], list[str]]:
    """Return the words with the first option of each swept group alone, and the word that tells the sweeper of them."""
    swept = {
        one.input_line: _key_choices(one)[0]
        for one in _parse_overrides(words)
        if one.is_discrete_sweep() and _is_group_choice(one, loader)
    }
    told = ",".join("'{}'".format(str(word).replace("\\", "\\\\").replace("'", "\\'")) for word in swept)
    return [swept.get(word, word) for word in words], [f"hydra.sweeper.first_options=[{told}]"] if swept else []


def _is_group_choice(one: Override, loader: ConfigLoader) -> bool:
    """Return whether a word chooses an option or is Hydra's own, in place of setting a value."""
    return one.is_hydra_override() or bool(loader.get_group_options(one.key_or_group))


def _fits_common(one: Override, common: Any) -> bool:
    """Return whether a word can be taken by what all jobs have in common, which takes it; Hydra
    knows no sweep of a deletion.
    """
    from omegaconf import OmegaConf
    from omegaconf.errors import OmegaConfBaseException

    if one.is_sweep_override() or one.is_delete():
        return True
    if (
        one.is_add()
        and not isinstance(one.value(), (dict, list))
        and OmegaConf.select(common, one.key_or_group) is not None
    ):
        return False
    try:
        OmegaConf.update(
            common, one.key_or_group, one.value(), merge=True, force_add=one.is_add() or one.is_force_add()
        )
    except OmegaConfBaseException:
        return False
    return True


def _as_choice_sweep(one: Override) -> str:
    return f"{one.get_key_element()}=choice({one.get_value_element_as_str()})"


def _parse_overrides(words: Sequence[str]) -> list[Override]:
    from hydra.core.override_parser.overrides_parser import OverridesParser

    return list(OverridesParser.create().parse_overrides(list(words)))
