"""The scenario pack ``arena``: what a robot meets among people, one thing at a time, and three halls."""

from arena_core import hookimpl


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_scenarios.conf"
