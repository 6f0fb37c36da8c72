"""``out=DIR``, the one spelling of where output goes, and the older ones that still count."""

from __future__ import annotations

import re
from collections.abc import Sequence

from arena_core.base.errors import ConfigurationError

OUT = "out"
EARLIER = "to"  # what commands that write one file called it: to=FILE, --to FILE
RUN_FOLDER, SWEEP_FOLDER = "hydra.run.dir", "hydra.sweep.dir"


def split_out(words: Sequence[str]) -> tuple[list[str], str | None]:
    """Return words without where the output goes, and that place; None where it is not given.

    ``--out DIR`` and ``--out=DIR`` are ``out=DIR``. Raises ConfigurationError for an empty place, and for two.
    """
    rest, found, left = list[str](), list[str](), list(words)
    while left:
        key, equals, value = left.pop(0).partition("=")
        if key not in (OUT, f"--{OUT}") or (key == OUT and not equals):
            rest.append(key + equals + value)
        else:
            found.append(value if equals else left.pop(0) if left else "")
    if len(found) > 1:
        raise ConfigurationError(f"{OUT} is given twice; allowed: each key once")
    if found == [""]:
        raise ConfigurationError(f"{OUT} is empty; allowed: {OUT}=DIR")
    return rest, found[0] if found else None


def run_folder_words(words: Sequence[str]) -> list[str]:
    """Return words of ``arena run`` for Hydra, which has two names of its own for ``out=DIR``.

    Both are given: which of them counts, the experiment may decide. Raises ConfigurationError where one is there
    already.
    """
    rest, place = split_out(words)
    if place is None:
        return rest
    for key in (RUN_FOLDER, SWEEP_FOLDER):
        if any(word.lstrip("+").partition("=")[0] == key for word in rest):
            raise ConfigurationError(f"{OUT} and {key} both say where the run goes; allowed: {OUT}=DIR alone")
    quoted = _quote_text(place)
    return [*rest, f"{RUN_FOLDER}={quoted}", f"{SWEEP_FOLDER}={quoted}"]


def _quote_text(text: str) -> str:
    """Return a text as Hydra reads it, whatever is in it; one in quotes is left as it is."""
    if len(text) > 1 and text[0] == text[-1] and text[0] in "'\"":
        return text
    escaped = re.sub(r"(\\*)('|$)", lambda found: 2 * found[1] + found[2].replace("'", "\\'"), text)
    return f"'{escaped}'"
