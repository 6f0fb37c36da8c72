"""The configuration groups of one plugin's folder, parsed by libyaml: PyYAML's own parser was half of the time to compose."""

import os
from functools import cache
from pathlib import Path
from typing import Any

import yaml
from hydra.core.object_type import ObjectType
from hydra.plugins.config_source import ConfigLoadError, ConfigResult, ConfigSource
from omegaconf import OmegaConf
from omegaconf._utils import get_yaml_loader


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
        from arena_core.config.option_file import check_option, option_text

        text = option_text(file)
        reader = loader()(text)  # a safe one
        node = reader.get_single_node()
        check_option(file, node)
        content = None if node is None else reader.construct_document(node)
        config = OmegaConf.create({} if content is None else content)
        return ConfigResult(self.provider, self.full_path(), config, self._get_header_dict(text))

    def available(self) -> bool:
        """Tell whether the folder is there."""
        return self.is_group("")

    def is_group(self, config_path: str) -> bool:
        """Tell whether there is a folder of this name."""
        return os.path.isdir(os.path.join(self.path, config_path))

    def is_config(self, config_path: str) -> bool:
        """Tell whether there is a file of this name."""
        return os.path.isfile(os.path.join(self.path, self._normalize_file_name(config_path)))

    def list(self, config_path: str, results_filter: ObjectType | None) -> list[str]:
        """Return the groups or options below a group, sorted."""
        found: list[str] = []
        for name in os.listdir(os.path.join(self.path, config_path)):
            self._list_add_result(found, os.path.join(config_path, name), name, results_filter)
        return sorted(set(found))


@cache
def loader() -> Any:
    """Return OmegaConf's own loader, on top of libyaml where PyYAML was built with it."""
    own: Any = get_yaml_loader()
    if not yaml.__with_libyaml__:
        return own
    from yaml.cyaml import CParser  # type: ignore[attr-defined]

    class Loader(CParser, own):  # type: ignore[misc]
        """Takes numbers and keys as OmegaConf does."""

        def __init__(self, stream: str) -> None:
            CParser.__init__(self, stream)
            yaml.constructor.SafeConstructor.__init__(self)
            yaml.resolver.Resolver.__init__(self)

    return Loader
