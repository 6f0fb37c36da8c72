"""The words of a command line: names, a command's own KEY=VALUE, and overrides of the configuration."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arena_core.base.errors import ConfigurationError
from arena_core.base.hints import did_you_mean
from arena_core.config.binding import read_settings
from arena_core.config.output_word import EARLIER, OUT

MARKS = "+~"  # with which Hydra adds and deletes a key
CONSTANTS = {"true": True, "false": False, "null": None}


@dataclass(frozen=True, slots=True)
class Words:
    """What follows a command: names, its own keys with their values, and overrides as they were given;
    ``usage`` is for messages.
    """

    usage: str
    names: tuple[str, ...]
    keys: Mapping[str, str]
    overrides: tuple[str, ...]

    def value(self, key: str, annotation: Any, default: Any) -> Any:
        """Return a key's value as ``annotation`` wants it, as in a configuration; raise ConfigurationError."""
        text = self.keys.get(key)
        return (
            default
            if text is None
            else read_settings(text if annotation is str else _parse_yaml(text), annotation, key)
        )

    def required(self, key: str) -> str:
        """Return the value of a key that has to be there; raise ConfigurationError."""
        if key not in self.keys:
            raise ConfigurationError(f"{key} is missing; allowed: {self.usage}")
        return self.keys[key]

    def source_and_target(self) -> tuple[Path, Path]:
        """Return the file that is read and the one that is written: ``IN out=OUT``, or ``IN OUT``; raise
        ConfigurationError.
        """
        given = [*self.names, *([self.keys[OUT]] if OUT in self.keys else [])]
        if len(given) != 2 or given[0].startswith("-") or not self.names:
            raise ConfigurationError(f"arguments are {' '.join(given) or 'none'}; allowed: {self.usage}")
        return Path(given[0]), Path(given[1])


def read_words(
    usage: str,
    words: Sequence[str],
    names: int | None = 0,
    keys: Collection[str] = (),
    overrides: Collection[str] | None = (),
) -> Words:
    """Sort the words of a command: so many ``names`` (None: any number), its own ``keys``, each once, and overrides.

    A key may be given as an option, too: ``--size 2`` is ``size=2``. The key ``out`` may be called ``to``, as it once
    was. ``overrides`` are the parts of the configuration that may be changed (None: all). Raises ConfigurationError for
    every other word.
    """
    words = _with_out(words, keys) if OUT in keys and EARLIER not in keys else _without_dashes(words, keys)
    assignments = [word for word in words if is_key_value(word)]
    own = [key_value(word) for word in assignments if word.partition("=")[0] in keys]
    others = tuple(word for word in assignments if word.partition("=")[0] not in keys)
    found = Words(usage, tuple(word for word in words if word not in assignments), dict(own), others)
    _check_names(found, names)
    _check_own(found, [key for key, _ in own])
    _check_overrides(found, keys, overrides)
    return found


def _without_dashes(words: Sequence[str], keys: Collection[str]) -> list[str]:
    """Turn ``--KEY VALUE`` and ``--KEY=VALUE`` of a command's own keys into KEY=VALUE."""
    found, rest = list[str](), list(words)
    while rest:
        word = rest.pop(0)
        key, equals, _ = word.removeprefix("--").partition("=")
        if word.startswith("--") and key in keys:
            word = word[2:] if equals else f"{key}={rest.pop(0)}" if rest else word
        found.append(word)
    return found


def _with_out(words: Sequence[str], keys: Collection[str]) -> list[str]:
    """Return the words with the earlier name of the output replaced by ``out``."""
    known = _without_dashes(words, (*keys, EARLIER))
    return [OUT + word.removeprefix(EARLIER) if word.startswith(f"{EARLIER}=") else word for word in known]


def key_value(word: str) -> tuple[str, str]:
    """Return key and value of KEY=VALUE, the key without Hydra's marks; the value is empty where there is none."""
    key, _, value = word.partition("=")
    return key.lstrip(MARKS), value


def is_key_value(word: str) -> bool:
    """Return whether a word is KEY=VALUE, or ~KEY, which deletes one; all others are names."""
    return "=" in word or word.startswith("~")


def _check_names(found: Words, names: int | None) -> None:
    wrong = names is not None and len(found.names) != names
    if wrong or any(name.startswith("-") for name in found.names):
        raise ConfigurationError(f"arguments are {' '.join(found.names) or 'none'}; allowed: {found.usage}")


def _check_own(found: Words, given: Sequence[str]) -> None:
    for key, value in found.keys.items():
        if given.count(key) > 1:
            raise ConfigurationError(f"{key} is given twice; allowed: each key once")
        if not value:
            raise ConfigurationError(f"{key} is empty; allowed: {found.usage}")


def _check_overrides(found: Words, keys: Collection[str], parts: Collection[str] | None) -> None:
    for key, _ in map(key_value, found.overrides):
        if parts is not None and key.partition(".")[0] not in parts:
            raise ConfigurationError(f"there is no key {key}{did_you_mean(key, keys) or ';'} allowed: {found.usage}")


def _parse_yaml(text: str) -> Any:
    for number in (int, float):
        with suppress(ValueError):
            return number(text)
    return CONSTANTS.get(text, text)
