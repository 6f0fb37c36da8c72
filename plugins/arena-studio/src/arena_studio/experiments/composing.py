"""From what a form holds to the words of ``arena run``, composed and checked by the core before anything starts."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError
from arena_core.hosting import check_settings, compose, load_registry, to_plain
from arena_studio.allowed_overrides import KEY, check_key, check_overrides

MOST_JOBS = 1000  # of one sweep
MOST_COMPOSED = 32  # of its jobs; each takes half a second
PLAIN = re.compile(r"[\w.+-][\w./+-]*", re.ASCII)  # what Hydra reads without quotes
STRUCTURED = re.compile(r"[\[{'\"].*|\w+\(.*\)", re.DOTALL)
LISTED = ("metrics",)  # groups of which several options are one choice
WORDLIKE = re.compile(r"[A-Za-z_][\w./-]*", re.ASCII)  # what Hydra reads as a text without quotes, but for NOT_TEXTS
NOT_TEXTS = ("null", "true", "false", "inf", "nan")
Alternatives = tuple[str, list[str]]  # a key and its values; none for a key that is deleted


@dataclass(frozen=True, slots=True)
class Composition:
    """An experiment before it starts: its ``words``, how many jobs and episodes it has, and the
    values of its first job by key.
    """

    words: tuple[str, ...]
    jobs: int
    episodes: int
    values: Mapping[str, Any]

    @property
    def is_sweep(self) -> bool:
        """Return whether it has several jobs."""
        return self.jobs > 1

    def command(self, folder: str, *, resume: bool = False) -> list[str]:
        """Return the words behind ``arena`` that run it into a folder."""
        place = "hydra.sweep.dir" if self.is_sweep else "hydra.run.dir"
        return [
            "run",
            *(["-m"] if self.is_sweep else []),
            *self.words,
            f"{place}={_quote_text(folder)}",
            *(["resume=true"] if resume else []),
        ]


def compose_experiment(choices: Mapping[str, Sequence[str]], values: Mapping[str, str], more: str) -> Composition:
    """Compose an experiment and check every value; raise ConfigurationError (one line) for the first that is wrong.

    ``choices`` are options by group, of which several make a sweep; ``values`` are texts by key, those with commas
    sweeps, too; ``more`` are words as one types them.
    """
    alternatives: list[Alternatives] = [
        *_choice_alternatives(choices),
        *_value_alternatives(values),
        *_typed_words(more),
    ]
    jobs = 1
    for _, offered in alternatives:
        jobs *= max(1, len(offered))
    if jobs > MOST_JOBS:
        raise ConfigurationError(f"the experiment has {jobs} jobs; allowed: up to {MOST_JOBS}")
    words = tuple(
        check_overrides([f"{key}={','.join(offered)}" if offered else key for key, offered in alternatives], Path.cwd())
    )
    configs = [_check_words(words) for words in _job_words(alternatives)]
    return Composition(words, jobs, jobs * int(configs[0]["episodes"]), dict(_flatten_values(configs[0])))


def shell_command(words: Sequence[str]) -> str:
    """Return a command as one types it in a shell."""
    return shlex.join(["arena", *words])


def _choice_alternatives(choices: Mapping[str, Sequence[str]]) -> Iterator[Alternatives]:
    for group, options in choices.items():
        for word in (group, *options):
            if not PLAIN.fullmatch(word):
                raise ConfigurationError(
                    f"{word!r} is no name of a group or an option; `arena list` shows what is installed"
                )
        if options:
            yield group, [f"[{','.join(options)}]"] if group in LISTED else list(options)


def _value_alternatives(values: Mapping[str, str]) -> Iterator[Alternatives]:
    for key, text in values.items():
        check_key(key)
        yield key, [_quote_value(part) for part in _sweep_values(text)]


def _typed_words(more: str) -> Iterator[Alternatives]:
    try:
        words = shlex.split(more)
    except ValueError as error:
        raise ConfigurationError(
            f"{more!r} cannot be read: {error}; allowed: KEY=VALUE, texts with spaces in quotes"
        ) from None
    for word in words:
        key, equals, value = word.partition("=")
        if not KEY.fullmatch(key) or not (equals or key.startswith("~")):
            raise ConfigurationError(f"{word!r} is no override; allowed: KEY=VALUE")
        yield key, _sweep_values(value) if equals else []


def _sweep_values(text: str) -> list[str]:
    """Return the values of a sweep; a list in brackets and a text in quotes are one value."""
    return [text.strip()] if STRUCTURED.fullmatch(text.strip()) else [part.strip() for part in text.split(",")]


def _quote_value(text: str) -> str:
    """Return a value as Hydra's grammar wants it."""
    return text if PLAIN.fullmatch(text) or STRUCTURED.fullmatch(text) else _in_quotes(text)


def _quote_text(text: str) -> str:
    """Return a text as Hydra's grammar wants it, so that it stays one whatever it says."""
    return text if WORDLIKE.fullmatch(text) and text.lower() not in NOT_TEXTS else _in_quotes(text)


def _in_quotes(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"


def _job_words(alternatives: Sequence[Alternatives]) -> Iterator[list[str]]:
    """Yield the words of the first job, then those of a job with each other value: every value is tried
    once, not every combination.
    """
    first = {key: offered[0] if offered else "" for key, offered in alternatives}
    tried = [first, *({**first, key: value} for key, offered in alternatives for value in offered[1:])]
    if len(tried) > MOST_COMPOSED:
        raise ConfigurationError(
            f"the sweep has {len(tried) - 1} values beside the first of each; allowed: up to {MOST_COMPOSED - 1}"
        )
    for one in tried:
        yield [f"{key}={value}" if value or not key.startswith("~") else key for key, value in one.items()]


def _check_words(words: Sequence[str]) -> dict[str, Any]:
    config = to_plain(compose(list(words)))
    check_settings(config, load_registry())
    return config


def _flatten_values(node: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, str]]:
    """Yield every value by its key, as it is typed."""
    for name, value in node.items():
        key = f"{above}.{name}" if above else str(name)
        if isinstance(value, Mapping) and value:
            yield from _flatten_values(value, key)
        else:
            yield key, _value_text(value)


def _value_text(value: Any) -> str:
    if value is None or isinstance(value, bool):
        return "null" if value is None else str(value).lower()
    if isinstance(value, (list, tuple)):
        return f"[{','.join(map(_value_text, value))}]"
    return str(value)
