"""Modules that only an extra of a distribution brings."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec

from arena_core.base.errors import ConfigurationError


def require_extra(feature: str, modules: Sequence[str], extra: str) -> None:
    """Raise ConfigurationError (one line) unless the modules that ``feature`` needs can be
    imported; ``extra`` brings them.
    """
    missing = [name for name in modules if find_spec(name) is None]
    if missing:
        raise ConfigurationError(f"{feature} needs {', '.join(missing)}; install the extra {extra}")
