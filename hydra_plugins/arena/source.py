"""The configuration groups of one plugin's folder, whose files are read within limits and
checked before they are expanded.
"""

import os
from collections.abc import Mapping
from copy import deepcopy
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import yaml
from hydra.core.object_type import ObjectType
from hydra.plugins.config_source import ConfigLoadError, ConfigResult, ConfigSource
from omegaconf import OmegaConf


class ArenaSource(ConfigSource):
    """Reads ``arena:///FOLDER`` as Hydra reads ``file:///FOLDER``."""

    @staticmethod
    def scheme() -> str:
        """Return the scheme of such paths."""
        return "arena"

    def load_config(self, config_path: str) -> ConfigResult:
        """Return the content of one option's file, with the package that its header names."""
        file = Path(self.path, self._normalize_file_name(config_path))
        if not file.is_file():
            raise ConfigLoadError(f"Config not found : {file}")
        from arena_core.config.option_file import option_text
        from arena_core.config.option_folders import RENAMED

        text = option_text(file)
        if Path(self.path).name == RENAMED:
            _tell_name(config_path, parse_option(file, text))
        config = deepcopy(_made_option(file, text))  # a composition changes what it is given
        return ConfigResult(self.provider, self.full_path(), config, self._get_header_dict(text))

    def available(self) -> bool:
        """Return whether the folder is there."""
        return self.is_group("")

    def is_group(self, config_path: str) -> bool:
        """Return whether there is a folder of this name."""
        return self._may_hold(config_path) and os.path.isdir(os.path.join(self.path, config_path))

    def is_config(self, config_path: str) -> bool:
        """Return whether there is a file of this name."""
        name = self._normalize_file_name(config_path)
        return self._may_hold(name) and os.path.isfile(os.path.join(self.path, name))

    @cached_property
    def _names(self) -> frozenset[str]:
        """What lies in the folder when a composition begins: it asks each plugin's for each option."""
        return frozenset(os.listdir(self.path)) if os.path.isdir(self.path) else frozenset()

    def _may_hold(self, place: str) -> bool:
        return not place or place.partition("/")[0] in self._names

    def list(self, config_path: str, results_filter: ObjectType | None) -> list[str]:
        """Return the groups or options below a group, sorted."""
        found: list[str] = []
        for name in os.listdir(os.path.join(self.path, config_path)):
            self._list_add_result(found, os.path.join(config_path, name), name, results_filter)
        return sorted(set(found))


def _tell_name(config_path: str, content: Mapping[str, Any]) -> None:
    """Say how an option that was asked for by a former name is called now: the first one that it derives from."""
    from arena_core.base.notices import print_notice

    group, _, name = config_path.removesuffix(".yaml").rpartition("/")
    print_notice(f"{group}={name} is called {group}={content['defaults'][0]} now; the old name works still")


@lru_cache(maxsize=1024)
def parse_option(file: Path, text: str) -> Any:
    """Return what the text of an option's file says, parsed once for all jobs of a multirun; raise InputFileError."""
    from arena_core.config.option_file import check_option

    check_option(file, yaml.compose(text, getattr(yaml, "CSafeLoader", yaml.SafeLoader)))
    return OmegaConf.to_container(OmegaConf.create(text), resolve=False)


@lru_cache(maxsize=1024)
def _made_option(file: Path, text: str) -> Any:
    """Return what an option's file says as OmegaConf has it: a copy takes half of the time of making it again."""
    return OmegaConf.create(parse_option(file, text))
