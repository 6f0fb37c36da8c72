"""Words that docstrings, comments, messages and pages do without; docs/vocabulary.md has others in their place."""

import os
import re
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[1]
PLAIN = {  # what must not come back: what stands in its place
    "tells? whether": "return whether",
    "whither": "where",
    "thereof": "of it",
    "anew": "again; replan, restart",
    "lest": "so that no ...",
    "hither|thither|whence|thence": "here, there, from where, from there",
    "dear(er)?": "costly, costlier",
    "for who asks": "for callers that ask",
    "the own": "its own, the person's own",
    "somebody": "a person, someone else",
    "pupils?": "student",
}
WORDS = re.compile("|".join(f"(?:{word})" for word in PLAIN))
BUILT = {"node_modules", "build", "dist", "site", "outputs", "multirun", "trainings", "__pycache__"}
SUFFIXES = {".py", ".md", ".yaml", ".yml", ".toml", ".txt", ".in", ".js", ".html", ".css", ""}
QUOTED = {"CHANGELOG.md", "docs/vocabulary.md", "tests/test_vocabulary.py"}  # old versions; the words themselves


def written_texts():
    """Return the paths of the texts that people write, relative to the checkout."""
    names = []
    for folder, inside, files in os.walk(TOP):
        inside[:] = [name for name in inside if name not in BUILT and not name.startswith(".")]
        names += [Path(folder, name).relative_to(TOP) for name in files]
    kept = [name for name in names if name.suffix in SUFFIXES and str(name) not in QUOTED]
    return sorted(name for name in kept if name.parts[:2] != ("tests", "data"))


def find_words(text):
    """Return the words of ``PLAIN`` that a text uses, but those that stand for any name, as in ``/home/somebody``."""
    found = []
    for match in WORDS.finditer(text.lower()):
        before, after = text[max(match.start() - 1, 0) : match.start()], text[match.end() : match.end() + 1]
        is_part = bool(re.match(r"\w", before) or re.match(r"\w", after))
        is_name = before in ("/", "=") or (before in ("'", '"') and before == after)
        if not is_part and not is_name:
            found.append(match[0])
    return found


def test_no_archaic_word_is_back():
    found = {}
    for name in written_texts():
        content = (TOP / name).read_bytes()
        if b"\0" not in content and (words := find_words(content.decode("utf-8", "replace"))):
            found[str(name)] = words
    assert found == {}


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ('"""Tell whether it stands."""', 1),
        ("the episode begins anew", 1),
        ("Somebody walks there", 1),
        ('"/home/somebody/maps", of=somebody and "somebody"', 0),
        ("its own way, renewed", 0),
    ],
)
def test_words_are_found_as_words(text, count):
    assert len(find_words(text)) == count
