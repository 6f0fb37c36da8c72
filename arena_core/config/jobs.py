"""Composes the jobs of one multirun: what a file holds is read and converted once, and merged as plain containers.

OmegaConf's nodes were most of what a job took. They are made once a job, of what is merged; Hydra's own node stays Hydra's.
"""

import pickle
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import replace
from typing import Any

from hydra._internal import config_loader_impl, defaults_list
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra._internal.config_repository import CachingConfigRepository, IConfigRepository
from hydra._internal.defaults_list import DefaultsList, Overrides
from hydra.core.config_search_path import ConfigSearchPath
from hydra.core.default_element import ResultDefault
from hydra.core.object_type import ObjectType
from hydra.errors import ConfigCompositionException
from hydra.plugins.config_source import ConfigResult, ConfigSource
from hydra.types import RunMode
from omegaconf import OmegaConf, flag_override, open_dict, read_write

MISSING = "???"
Names = tuple[tuple[str, str | None], ...]  # the files of a defaults list, each with its package


class KeptFiles(IConfigRepository):
    """Hydra's configuration sources, each file of which is read once for all jobs; nobody may change what it returns."""

    def __init__(self, sources: IConfigRepository) -> None:
        self.sources = sources
        self._files: dict[str, ConfigResult | None] = {}
        self._there: dict[tuple[str, str], bool] = {}
        self.lists: dict[Any, DefaultsList] = {}
        self.told = True  # whether the sources are told to who asks for them

    def __deepcopy__(self, memo: Mapping[int, Any]) -> "KeptFiles":
        """Return what a job may give other sources, as ``hydra.searchpath`` does; until then it shares what is kept."""
        copy = KeptFiles(self.sources)
        copy._files, copy._there, copy.lists, copy.told = self._files, self._there, self.lists, self.told
        return copy

    def initialize_sources(self, config_search_path: ConfigSearchPath) -> None:
        """Take other sources from now on."""
        self.sources = deepcopy(self.sources)
        self.sources.initialize_sources(config_search_path)
        self._files, self._there, self.lists = {}, {}, {}

    def load_config(self, config_path: str) -> ConfigResult | None:
        """Return the content of a file, None where there is none."""
        if config_path not in self._files:
            self._files[config_path] = self.sources.load_config(config_path)
        return self._files[config_path]

    def group_exists(self, config_path: str) -> bool:
        """Tell whether any source has such a group."""
        return self._known("group", config_path)

    def config_exists(self, config_path: str) -> bool:
        """Tell whether any source has such a file."""
        return self._known("config", config_path)

    def get_schema_source(self) -> ConfigSource:
        """Return the source of structured configurations."""
        return self.sources.get_schema_source()

    def get_group_options(self, group_name: str, results_filter: ObjectType | None = ObjectType.CONFIG) -> list[str]:
        """Return the options of a group, of all sources."""
        return self.sources.get_group_options(group_name, results_filter)

    def get_sources(self) -> list[ConfigSource]:
        """Return the sources, in their order; none while they are not to be told."""
        return self.sources.get_sources() if self.told else []

    def _known(self, kind: str, path: str) -> bool:
        if (kind, path) not in self._there:
            self._there[kind, path] = getattr(self.sources, f"{kind}_exists")(path)
        return self._there[kind, path]


def choices_made(overrides: Any, defaults: Sequence[Any], self_added: bool, by_hydra: Any = defaults_list._create_interpolation_map) -> Any:
    """Return the choices that interpolations of a defaults list refer to; Hydra collects them for lists without any as well."""
    return by_hydra(overrides, defaults, self_added) if any(default.is_interpolation() for default in defaults) else OmegaConf.create()


def files_of(
    repo: Any,
    config_name: str | None,
    overrides_list: Any,
    prepend_hydra: bool,
    skip_missing: bool,
    by_hydra: Any = defaults_list.create_defaults_list,
) -> DefaultsList:
    """Return the files of a job as Hydra lists them; jobs that choose the same options have the same list."""
    files = getattr(repo, "delegate", None)
    if not isinstance(files, KeptFiles):
        return by_hydra(repo, config_name, overrides_list, prepend_hydra, skip_missing)  # type: ignore[no-any-return]
    chosen = tuple(override.input_line for override in overrides_list if files.group_exists(override.key_or_group))
    key = config_name, chosen, prepend_hydra, skip_missing
    if key not in files.lists:
        files.lists[key] = by_hydra(repo, config_name, overrides_list, prepend_hydra, skip_missing)
    overrides = Overrides(repo=repo, overrides_list=overrides_list)
    return replace(files.lists[key], config_overrides=overrides.config_overrides)


def apply_what_is_there(overrides: Sequence[Any], config: Any, by_hydra: Any = ConfigLoaderImpl._apply_overrides_to_config) -> None:
    """Apply the overrides of a multirun to what it has in common; keys that this lacks are for its jobs, whose components may have them."""
    for override in overrides:
        try:
            by_hydra([override], config)
        except ConfigCompositionException:
            if override.is_hydra_override():
                raise


class Jobs:
    """Makes a loader of configurations compose one job after the other quickly; what it returns is what Hydra would return."""

    def __init__(self, loader: Any) -> None:
        self._loader = loader
        self._merge_by_hydra = loader._compose_config_from_defaults_list
        self._contents: dict[tuple[str, str | None], dict[str, Any]] = {}
        self._hydra: dict[Names, Any] = {}
        self._merged: dict[Names, bytes] = {}
        self._sources: bytes | None = None
        self._load_by_hydra = loader.load_sweep_config
        self._compose_by_hydra = loader._load_configuration_impl
        loader.repository = KeptFiles(loader.repository)
        loader.load_sweep_config = self.load
        loader._load_configuration_impl = self.compose
        vars(defaults_list)["_create_interpolation_map"] = choices_made
        vars(config_loader_impl)["create_defaults_list"] = files_of
        loader._compose_config_from_defaults_list = self._merge

    def compose(self, run_mode: RunMode, **others: Any) -> Any:
        """Compose as Hydra does; of a multirun, what its jobs have in common."""
        if run_mode is not RunMode.MULTIRUN:
            return self._compose_by_hydra(run_mode=run_mode, **others)
        all_of_them, those_that_fit = (staticmethod(apply) for apply in (ConfigLoaderImpl._apply_overrides_to_config, apply_what_is_there))
        loader: Any = ConfigLoaderImpl
        loader._apply_overrides_to_config = those_that_fit
        try:
            return self._compose_by_hydra(run_mode=run_mode, **others)
        finally:
            loader._apply_overrides_to_config = all_of_them

    def load(self, master_config: Any, sweep_overrides: list[str]) -> Any:
        """Compose a job as Hydra does; where its files come from is a list of typed nodes, the same for every job of the multirun."""
        if self._sources is None:
            sources = deepcopy(master_config.hydra.runtime.config_sources)
            sources._set_parent(None)  # which would bring the whole configuration along
            self._sources = pickle.dumps(sources, pickle.HIGHEST_PROTOCOL)
        elsewhere = any("hydra.searchpath=" in override for override in sweep_overrides)  # whose files come from sources of its own
        self._loader.repository.told = elsewhere
        try:
            config = self._load_by_hydra(master_config, sweep_overrides)
        finally:
            self._loader.repository.told = True
        if not elsewhere:
            runtime = config.hydra.runtime
            with read_write(runtime), open_dict(runtime), flag_override(runtime, "no_deepcopy_set_nodes", True):
                runtime.config_sources = pickle.loads(self._sources)  # noqa: S301 - made above
        return config

    def _merge(self, defaults: list[ResultDefault], repo: Any) -> Any:
        """Merge the files of a defaults list, in its order."""
        files: KeptFiles = repo.delegate
        if files._files is not self._loader.repository._files:  # a search path of its own
            return self._merge_by_hydra(defaults, repo)
        names = tuple(map(_name, defaults))
        if names not in self._merged:
            self._merged[names] = pickle.dumps(self._merge_files(defaults, files), pickle.HIGHEST_PROTOCOL)
        return pickle.loads(self._merged[names])  # noqa: S301 - made a line above; a tenth of what making or copying the nodes takes

    def _merge_files(self, defaults: list[ResultDefault], files: KeptFiles) -> Any:
        contents = [self._content(default, files) for default in defaults]
        whole: dict[str, Any] = {}
        try:
            for content in contents:
                merge(whole, {key: value for key, value in content.items() if key != "hydra"})
        except Unmergeable:
            return self._merge_by_hydra(defaults, CachingConfigRepository(files.sources))
        config: Any = OmegaConf.create({"hydra": None, **whole})
        own = [default for default, content in zip(defaults, contents, strict=True) if "hydra" in content]
        with flag_override(config, "no_deepcopy_set_nodes", True):
            config.hydra = deepcopy(self._hydra_node(own, files))
        return config

    def _content(self, default: ResultDefault, files: KeptFiles) -> dict[str, Any]:
        """Return what a file adds, in its package, as plain containers."""
        name = _name(default)
        if name not in self._contents:
            result = self._loader._load_single_config(default, files.sources)
            content: Any = OmegaConf.to_container(result.config, resolve=False)
            package = default.package if default.package is not None else result.header["package"]
            _at(content, package).pop("defaults", None)
            self._contents[name] = content
        return self._contents[name]

    def _hydra_node(self, defaults: list[ResultDefault], files: KeptFiles) -> Any:
        """Return Hydra's own node, which is typed, and the same for most jobs."""
        names = tuple(map(_name, defaults))
        if names not in self._hydra:
            self._hydra[names] = self._merge_by_hydra(defaults, CachingConfigRepository(files.sources)).hydra
        return self._hydra[names]


@contextmanager
def quick_loaders() -> Iterator[None]:
    """Let every loader that Hydra makes inside compose as jobs are composed: Hydra composes a single run twice as well."""
    made: Any = ConfigLoaderImpl.__init__

    def make(loader: Any, config_search_path: ConfigSearchPath) -> None:
        made(loader, config_search_path)
        Jobs(loader)

    ConfigLoaderImpl.__init__ = make  # type: ignore[method-assign, assignment]
    try:
        yield
    finally:
        ConfigLoaderImpl.__init__ = made  # type: ignore[method-assign]


class Unmergeable(Exception):
    """Where a mapping is to be merged into an interpolation, OmegaConf alone knows what comes of it."""


def merge(whole: dict[str, Any], content: Mapping[str, Any]) -> None:
    """Merge a mapping into another one as OmegaConf does: mappings key by key, all else replaced, unless it is missing."""
    for key, value in content.items():
        before = whole.get(key)
        if isinstance(value, Mapping) and isinstance(before, dict):
            merge(before, value)
        elif isinstance(value, Mapping) and isinstance(before, str) and "${" in before:
            raise Unmergeable(key)
        elif value != MISSING or key not in whole:
            whole[key] = copied(value)


def copied(value: Any) -> Any:
    """Return a copy of plain containers; nothing in them refers to itself."""
    if isinstance(value, dict):
        return {key: copied(item) for key, item in value.items()}
    return [copied(item) for item in value] if isinstance(value, list) else value


def _name(default: ResultDefault) -> tuple[str, str | None]:
    return str(default.config_path), default.package


def _at(content: dict[str, Any], package: str | None) -> dict[str, Any]:
    for part in package.split(".") if package else ():
        content = content[part]
    return content
