"""Which words of a command line a browser may send: no interpolation, no key of Hydra's own, no place
outside the project folder.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError
from arena_core.commands import one_line

KEY = re.compile(r"[+~]{0,2}[A-Za-z_][\w./@-]*", re.ASCII)
INTERPOLATION = "${"
HYDRA = "hydra"
CONFIGURATION = "conf"  # the folder of the user's own configuration


def check_overrides(words: Sequence[str], root: Path) -> list[str]:
    """Return overrides that came from a browser as they are; raise ConfigurationError for the first that it may not
    send.

    Words are held against what Hydra reads in them, not against how they are written. ``root`` is the project folder.
    """
    from hydra.core.override_parser.overrides_parser import OverridesParser

    check_configuration(root)
    parser = OverridesParser.create()
    for word in words:
        key, _, written = word.partition("=")
        check_key(key)
        _check_plain(written, key)
        for text in _value_texts(_parse_value(parser, word)):
            check_text(text, key, root)
    return list(words)


def check_key(key: str) -> None:
    """Raise ConfigurationError for what is no key of the configuration, and for one of Hydra's own."""
    if not KEY.fullmatch(key):
        raise ConfigurationError(f"{one_line(key, 80)!r} is no key of the configuration; allowed: KEY=VALUE")
    if HYDRA in re.split(r"[./@+~]", key) or key.lstrip("+~") == "out":
        raise ConfigurationError(
            f"{one_line(key, 80)} is Hydra's own; allowed: keys of the experiment (the studio chooses the folder)"
        )


def check_text(text: str, key: str, root: Path) -> None:
    """Raise ConfigurationError for an interpolation, which reads the environment, and for a path that leads
    out of the project folder.
    """
    _check_plain(text, key)
    if is_outside(text, root):
        raise ConfigurationError(
            f"{key} is {one_line(text, 80)!r}, which leads out of the project folder; allowed: a path inside it"
        )


def _check_plain(text: str, key: str) -> None:
    if INTERPOLATION in text:
        raise ConfigurationError(f"{key} holds an interpolation, {one_line(text, 80)!r}; allowed: values as they are")


def is_outside(text: str, root: Path) -> bool:
    """Return whether a text, taken as a path from the project folder, is a place outside it, links followed."""
    if text.startswith("~"):
        return True
    try:
        real = Path(os.path.realpath(root / text))
    except (OSError, ValueError):  # no file can be called so
        return False
    return not real.is_relative_to(os.path.realpath(root))


def check_configuration(root: Path) -> None:
    """Raise ConfigurationError where a link in the project's own configuration leads out of it."""
    for folder, folders, names in os.walk(root / CONFIGURATION):
        for path in (Path(folder), *(Path(folder, name) for name in (*folders, *names))):
            if path.is_symlink() and is_outside(path.as_posix(), root):
                raise ConfigurationError(
                    f"{path.relative_to(root)} leads out of the project folder; allowed: files inside it"
                )


def _parse_value(parser: Any, word: str) -> Any:
    """Return what Hydra reads as a word's value; raise ConfigurationError for what it cannot read."""
    from hydra.core.override_parser.types import Override
    from hydra.errors import HydraException

    try:
        override: Override = parser.parse_override(word)
    except HydraException as error:
        raise ConfigurationError(
            f"{one_line(word, 80)!r} cannot be read: {one_line(str(error).splitlines()[0], 120)}; allowed: KEY=VALUE"
        ) from None
    return override.value()


def _value_texts(value: Any) -> Iterator[str]:
    """Yield all texts of a value, keys of mappings among them."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for key, inside in value.items():
            yield from (*_value_texts(key), *_value_texts(inside))
    elif isinstance(value, list | tuple | set | frozenset):
        for inside in value:
            yield from _value_texts(inside)
    else:  # a sweep, or a text in quotes: what they hold
        yield from _value_texts(
            [getattr(value, name) for name in ("text", "list", "include", "exclude", "args") if hasattr(value, name)]
        )
