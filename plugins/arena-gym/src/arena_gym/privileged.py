"""Parts that see the truth in training: refused unless the recipe says so."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from arena_core import ConfigurationError
from arena_core.hosting import PrivilegedPart, privileged_names, watch_privileged


@contextmanager
def allowed_privileged(config: Mapping[str, Any]) -> Iterator[list[PrivilegedPart]]:
    """Collect the privileged parts that are built meanwhile; raise ConfigurationError for any unless the training's
    ``config`` allows them.
    """
    with watch_privileged() as seeing:
        yield seeing
    if seeing and config.get("privileged") is not True:
        raise ConfigurationError(
            f"{' and '.join(privileged_names(seeing))} would see the truth in training; allowed: what sees sensors "
            "alone, or privileged=true, which the policy's card then says"
        )
