"""How a good file becomes a bad one: bytes, words and numbers, and where a format has a tree, its nodes."""

from __future__ import annotations

import io
import json
import re
import sqlite3
import struct
import tempfile
from contextlib import closing, suppress
from copy import deepcopy
from functools import lru_cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from hypothesis import strategies as st

NUMBERS = (
    *(
        "0",
        "-1",
        "1",
        "0.0",
        "-0.0",
        "1e-300",
        "1e-12",
        "1e308",
        "-1e308",
        "1e999",
        "nan",
        "inf",
        "-inf",
        "NaN",
        "Infinity",
        ".inf",
        ".nan",
    ),
    *(
        "2147483648",
        "-2147483649",
        "9223372036854775808",
        "99999999999999999999",
        "1" * 5000,
        "0x10",
        "1_0",
        "1e",
        "٣",
        "true",
        "null",
    ),
    *("6e6", "-6e6", "1e8", "1e12", "1e300", "-1e300"),
)
WORDS = (
    *(
        "!!bool x",
        "!!int ''",
        "!!float ''",
        "!!timestamp x",
        "!!binary x",
        "!!set x",
        "!!omap x",
        "!!python/object:os.system x",
    ),
    *(
        "&a [*a]",
        "<<: *a",
        "? [a]: b",
        "[" * 2000,
        "{" * 2000,
        '{"a":' * 2000,
        "]" * 9,
        "\0",
        "\r\n",
        "\t",
        "\ufeff",
        "\ud7ff",
        "%",
        "---",
        "|",
        ">",
    ),
    *(
        "../../etc/passwd",
        "/etc/passwd",
        "/dev/zero",
        "/dev/stdin",
        ".",
        "..",
        "~",
        "a" * 5000,
        "name with spaces",
        "pkg://arena_core/x",
        "=1+1",
        "a\r=1+1",
        "\x85",
        "\u2028",
        "\x1b[31m",
        "a\x1b]0;b\x07",
        "a\rb",
        "a\0b",
    ),
    *(
        "<!DOCTYPE a [<!ENTITY b 'c'>]>",
        "&lt;",
        "&#0;",
        "&b;",
        "<a>",
        "</a>",
        "<a/>" * 500,
        "<!--",
        "]]>",
        "<model>" * 300,
        "-",
        ":",
        ",",
        '"',
        "'",
    ),
)
VALUES: tuple[Any, ...] = (
    *(
        None,
        True,
        False,
        0,
        -1,
        1,
        2**31,
        2**63,
        10**30,
        1e308,
        -1e308,
        1e-300,
        0.5,
        "",
        "x",
        "nan",
        "../x",
        "/dev/zero",
        "\0",
        "\n",
        "a\r=1+1",
        "\x85\u2028",
        "a\0b",
        "\x1b[31mred",
        "\ud800",
        6e6,
        -6e6,
        1e8,
        1e300,
        "a" * 3000,
    ),
    *(
        [],
        {},
        [[]],
        [None],
        [1, 2],
        [1, 2, 3],
        ["a"],
        {"": 0},
        {"x": 1, "y": 2},
        [0] * 200,
        [[0.0, 0.0]] * 50,
        {"name": "dwa"},
    ),
)
FAR = (6e6, -6e6, 1e8, 1e12, 1e300, np.inf, -np.inf, np.nan)  # one number far off among good ones
JUMPS = (-(10**8), -10, -1, 1, 10, 10**8, 2**31 - 2000)  # s, of stamps
BEGIN = 1000  # s, near which the recordings of tests begin
KEYS = ("", "name", "x", "\n", "a\r=1+1", "\0", "\x1b[31m", "a" * 300)
KINDS = ("f4", "f8", "i1", "i4", "i8", "u8", "?", "S3", "U2", "c16", "M8[s]")
SHAPES = ((), (0,), (1,), (3,), (2, 3), (0, 3), (1, 1, 1), (5, 2), (4, 4, 4))


@st.composite
def changed_bytes(draw: st.DrawFn, content: bytes) -> bytes:
    """Cut, doubled, overwritten and spliced bytes."""
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(content)))
        until = min(len(content), at + draw(st.integers(0, 40)))
        way = draw(st.integers(0, 5))
        new = (
            draw(st.binary(max_size=12))
            if way < 3
            else draw(st.sampled_from((*WORDS, *NUMBERS))).encode("utf-8", "surrogatepass")
        )
        if way == 0:
            content = content[:at]
        elif way == 1:
            content = content[:until] + content[at:]
        else:
            content = content[:at] + new + content[until:]
    return content


@st.composite
def changed_text(draw: st.DrawFn, content: bytes) -> bytes:
    """Words and numbers of a text replaced, lines left out, doubled and put elsewhere."""
    text = content.decode("utf-8", "replace")
    for _ in range(draw(st.integers(1, 3))):
        words = [m.span() for m in re.finditer(r"[-+.\w]+", text)]
        lines = text.split("\n")
        way = draw(st.integers(0, 4))
        if way < 3 and words:
            begin, end = draw(st.sampled_from(words))
            text = text[:begin] + draw(st.sampled_from((*NUMBERS, *WORDS))) + text[end:]
        elif way == 3:
            lines.pop(draw(st.integers(0, len(lines) - 1)))
            text = "\n".join(lines)
        else:
            text = "\n".join([*lines, draw(st.sampled_from(lines)), draw(st.sampled_from(WORDS))])
    return text.encode("utf-8", "surrogatepass")


@st.composite
def changed_tree(draw: st.DrawFn, tree: Any) -> Any:
    """A tree of mappings and lists with some nodes replaced, left out, renamed or many times there."""
    tree = json.loads(json.dumps(tree))
    for _ in range(draw(st.integers(1, 3))):
        places = list(_places(tree))
        if not places:
            return deepcopy(draw(st.sampled_from(VALUES)))
        parent, key = places[draw(st.integers(0, len(places) - 1))]
        way = draw(st.integers(0, 6))
        if way == 0:
            del parent[key]
        elif way == 1 and isinstance(parent, dict):
            parent[draw(st.sampled_from(KEYS))] = parent.pop(key)
        elif way == 2 and isinstance(parent, list):
            parent.extend([parent[key]] * draw(st.sampled_from((1, 20, 300))))
        elif way == 3:
            parent[key] = [parent[key]]
        else:
            parent[key] = deepcopy(draw(st.sampled_from(VALUES)))
    return tree


def _places(tree: Any) -> Any:
    """Yield every (container, key) of a tree."""
    for key, value in list(
        tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    ):
        yield tree, key
        yield from _places(value)


@st.composite
def changed_json(draw: st.DrawFn, content: bytes) -> bytes:
    """A JSON file with its tree changed; constants that JSON has not are written too."""
    return json.dumps(draw(changed_tree(json.loads(content)))).encode("utf-8", "surrogatepass")


@st.composite
def changed_yaml(draw: st.DrawFn, content: bytes) -> bytes:
    """A YAML file with its tree changed."""
    import yaml

    return yaml.safe_dump(draw(changed_tree(yaml.safe_load(content)))).encode("utf-8", "surrogatepass")


@st.composite
def changed_xml(draw: st.DrawFn, content: bytes) -> bytes:
    """An XML file with elements left out, doubled or moved into each other, and other texts and attributes."""
    root = ElementTree.fromstring(content)
    for _ in range(draw(st.integers(1, 3))):
        elements = list(root.iter())
        one, other = draw(st.sampled_from(elements)), draw(st.sampled_from(elements))
        way = draw(st.integers(0, 4))
        if way == 0 and len(one):
            one.remove(draw(st.sampled_from(list(one))))
        elif way == 1 and other is not one and one not in list(other.iter()):
            one.append(other)
        elif way == 2:
            one.tag = draw(st.sampled_from(sorted({e.tag for e in elements})))
        elif way == 3 and one.attrib:
            one.set(
                draw(st.sampled_from(sorted(one.attrib))),
                draw(st.sampled_from((*NUMBERS, "", "1 2", "0 0 0 0 0 nan", "plane"))),
            )
        else:
            one.text = draw(st.sampled_from((*NUMBERS, "", "1 2 3", "0 0 0 0 0 1e308", "-1 -1 -1", "1e9 1e9 1e9")))
    if _weight(root) > 20_000:
        return content
    return ElementTree.tostring(root)


def _weight(element: ElementTree.Element, depth: int = 0) -> int:
    """Return how many elements there are, very many where some contain each other."""
    return 10**9 if depth > 50 else 1 + sum(_weight(child, depth + 1) for child in element)


@st.composite
def changed_npz(draw: st.DrawFn, content: bytes) -> bytes:
    """An .npz file with arrays of another kind, shape or content, left out or added, and another tree in ``meta``."""
    with np.load(io.BytesIO(content)) as file:
        arrays = {name: file[name] for name in file.files}
    for _ in range(draw(st.integers(1, 2))):
        name = draw(st.sampled_from(sorted(arrays)))
        way = draw(st.integers(0, 8))
        if name == "meta" and way < 4 and str(arrays[name]).startswith("{"):  # not spoilt in the first round
            arrays[name] = np.array(json.dumps(draw(changed_tree(json.loads(str(arrays[name]))))))
        elif way == 0:
            del arrays[name]
        elif way == 1:
            arrays[name] = np.zeros(draw(st.sampled_from(SHAPES)), draw(st.sampled_from(KINDS)))
        elif way == 2 and arrays[name].dtype.kind == "f":
            arrays[name] = np.full_like(arrays[name], draw(st.sampled_from((np.nan, np.inf, -np.inf, 1e38, 0.0, -1.0))))
        elif way == 6 and arrays[name].dtype.kind == "f" and arrays[name].size:
            one = arrays[name].astype(np.float64)
            one.flat[draw(st.integers(0, one.size - 1))] = draw(st.sampled_from(FAR))
            arrays[name] = one
        elif way == 8 and arrays[name].dtype.kind == "f" and arrays[name].ndim:
            later = arrays[name].astype(np.float64)
            later[draw(st.integers(0, len(later))) :] += draw(st.sampled_from((*FAR, *JUMPS)))
            arrays[name] = later
        elif way == 7 and arrays[name].ndim:
            arrays[name] = np.concatenate([arrays[name]] * 2)
        elif way == 3 and arrays[name].ndim:
            arrays[name] = arrays[name][: draw(st.integers(0, len(arrays[name])))]
        else:
            arrays[name] = np.atleast_1d(arrays[name])[..., None]
        if not arrays:
            break
    packed = io.BytesIO()
    np.savez(packed, **arrays)
    return packed.getvalue()


@st.composite
def changed_numbers(draw: st.DrawFn, content: bytes) -> bytes:
    """Numbers of a binary file put far off where they stand: doubles of the size of metres and
    radians, and whole seconds of stamps.
    """
    doubles, seconds = numbers_of(content)
    changed = bytearray(content)
    for _ in range(draw(st.integers(1, 3))):
        if seconds and draw(st.booleans()):
            at = draw(st.sampled_from(seconds))
            (second,) = struct.unpack_from("<i", changed, at)
            struct.pack_into("<i", changed, at, max(-(2**31), min(2**31 - 1, second + draw(st.sampled_from(JUMPS)))))
        elif doubles:
            struct.pack_into("<d", changed, draw(st.sampled_from(doubles)), draw(st.sampled_from(FAR)))
    return bytes(changed)


@lru_cache(maxsize=8)
def numbers_of(content: bytes) -> tuple[list[int], list[int]]:
    """Return where doubles of 0.01 to 100 seem to stand, and whole seconds of the stamps that
    recordings of tests have.
    """
    doubles, seconds = [], []
    for shift in range(8):
        row = np.frombuffer(content[shift : shift + (len(content) - shift) // 8 * 8], "<f8")
        with np.errstate(invalid="ignore"):
            doubles += (np.flatnonzero((np.abs(row) > 0.01) & (np.abs(row) < 100.0)) * 8 + shift).tolist()
    for shift in range(4):
        whole = np.frombuffer(content[shift : shift + (len(content) - shift) // 4 * 4], "<i4")
        seconds += (np.flatnonzero((whole >= BEGIN) & (whole < BEGIN + 100)) * 4 + shift).tolist()
    return doubles, seconds


@st.composite
def changed_data_base(draw: st.DrawFn, content: bytes) -> bytes:
    """A SQLite file in which tables are views, virtual, computed or without order, and cells are blobs
    without content or far numbers.
    """
    with tempfile.NamedTemporaryFile(suffix=".db3") as file:
        file.write(content)
        file.flush()
        with closing(sqlite3.connect(file.name, isolation_level=None)) as base:
            for _ in range(draw(st.integers(1, 2))):
                with suppress(sqlite3.Error):  # the one before has taken away what it is about
                    base.executescript(
                        draw(st.sampled_from(STATEMENTS)).format(number=draw(st.sampled_from(SQL_NUMBERS)))
                    )
        return Path(file.name).read_bytes()


ENDLESS = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n)"
SQL_NUMBERS = (
    "0",
    "-1",
    "1e300",
    "-9e999",
    "NULL",
    "'x'",
    "9223372036854775807",
    "-9223372036854775808",
    "1e17",
    "zeroblob(9)",
)
STATEMENTS = (
    *(
        f"ALTER TABLE {table} RENAME TO old; CREATE VIEW {table} AS {endless}"
        for table, endless in (
            ("messages", f"{ENDLESS} SELECT i AS id, 1 AS topic_id, i AS timestamp, zeroblob(9) AS data FROM n"),
            (
                "topics",
                f"{ENDLESS} SELECT i AS id, 'a' AS name, 'b' AS type FROM n",
            ),
            ("messages", "SELECT * FROM old"),
            ("topics", "SELECT * FROM old"),
        )
    ),
    "ALTER TABLE messages RENAME TO old; CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, "
    "data AS (zeroblob(900000000))); INSERT INTO messages(id, topic_id, timestamp) SELECT id, topic_id, "
    "timestamp FROM old",
    "ALTER TABLE messages RENAME TO old; CREATE TABLE messages(id, topic_id, timestamp, data); "
    "INSERT INTO messages SELECT * FROM old",
    "ALTER TABLE messages RENAME TO old; CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, "
    "data) WITHOUT ROWID",
    "ALTER TABLE messages RENAME TO old; CREATE VIRTUAL TABLE messages USING fts5(id, topic_id, timestamp, data)",
    "CREATE INDEX i ON messages(timestamp); DROP TABLE topics",
    "CREATE VIEW v AS SELECT * FROM v",
    "UPDATE messages SET data = zeroblob(80000000) WHERE id % 40 = 1",
    "UPDATE messages SET data = zeroblob(length(data))",
    "UPDATE messages SET data = {number} WHERE id % 7 = 1",
    "UPDATE messages SET timestamp = {number} WHERE id % 7 = 1",
    "UPDATE messages SET timestamp = timestamp + {number} WHERE id > 100",
    "UPDATE messages SET topic_id = {number} WHERE id % 7 = 1",
    "UPDATE messages SET id = {number} WHERE id = 50",
    "UPDATE topics SET id = {number} WHERE id = 1",
    "UPDATE topics SET type = {number} WHERE id = 1",
    "UPDATE topics SET name = '/a' || char(13, 61, 49, 0, 27) WHERE id % 2 = 1",
    "UPDATE topics SET type = 'a/msg/' || char(13, 61, 49, 0, 27) WHERE id % 2 = 1",
    "UPDATE topics SET type = (SELECT type FROM topics WHERE id = 2)",
    "UPDATE topics SET name = (SELECT name FROM topics WHERE id = 2)",
)


@st.composite
def changed_table(draw: st.DrawFn, content: bytes) -> bytes:
    """A CSV file with other cells, columns left out and rows of another length."""
    rows = [line.split(",") for line in content.decode().splitlines()]
    for _ in range(draw(st.integers(1, 4))):
        row = draw(st.sampled_from(rows))
        if not row:
            continue
        at = draw(st.integers(0, len(row) - 1))
        way = draw(st.integers(0, 3))
        if way == 0:
            row.pop(at)
        elif way == 1:
            rows.append(list(row))
        else:
            row[at] = draw(
                st.sampled_from((*NUMBERS, "", '"', '"a\nb"', "=1+1", "a" * 200, "goal_reached", "-5", "1.5"))
            )
    return "\n".join(",".join(row) for row in rows).encode()
