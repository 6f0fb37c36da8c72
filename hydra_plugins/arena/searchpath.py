"""Tell Hydra where plugins keep their configuration groups."""

from hydra.core.config_search_path import ConfigSearchPath
from hydra.plugins.search_path_plugin import SearchPathPlugin


class ArenaSearchPath(SearchPathPlugin):
    """Append every plugin's configuration package, then the user's ``conf`` folder."""

    def manipulate_search_path(self, search_path: ConfigSearchPath) -> None:
        """Append the sources in order of plugin name; leave other Hydra applications alone."""
        from arena_core.config.option_folders import conf_directory
        from arena_core.config.option_folders import search_path as sources

        if str(conf_directory()) not in [
            item.path.removeprefix("file://") for item in search_path.get_path() if item.path
        ]:
            return
        # ahead of Hydra's own source of the same folder, which parses YAML in Python each time
        search_path.prepend(provider="arena-core", path=f"arena://{conf_directory()}")
        for provider, path in sources():
            search_path.append(provider=f"arena-{provider}", path=path)
