"""Words that docstrings, comments, messages and pages do without; docs/vocabulary.md has others in their place."""

import re
import subprocess
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
SUFFIXES = {".py", ".md", ".yaml", ".yml", ".toml", ".txt", ".in", ".js", ".html", ".css", ""}
QUOTED = {"CHANGELOG.md", "docs/vocabulary.md", "tests/test_vocabulary.py"}  # old versions; the words themselves


def tracked_texts():
    """Return the paths of the texts that people write, relative to the checkout."""
    listed = subprocess.run(["git", "ls-files"], cwd=TOP, capture_output=True, text=True, check=False)
    if listed.returncode:
        pytest.skip("no checkout of git")
    names = [Path(name) for name in listed.stdout.splitlines() if name not in QUOTED]
    return [name for name in names if name.suffix in SUFFIXES and name.parts[:2] != ("tests", "data")]


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
    for name in tracked_texts():
        content = (TOP / name).read_bytes() if (TOP / name).is_file() else b""
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
