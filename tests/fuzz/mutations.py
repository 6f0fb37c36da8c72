"""How a good file becomes a bad one: bytes, words and numbers, and where a format has a tree, its nodes."""

from __future__ import annotations

import io
import json
import re
from copy import deepcopy
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
    *("2147483648", "-2147483649", "9223372036854775808", "99999999999999999999", "1" * 5000, "0x10", "1_0", "1e", "٣", "true", "null"),
)
WORDS = (
    *("!!bool x", "!!int ''", "!!float ''", "!!timestamp x", "!!binary x", "!!set x", "!!omap x", "!!python/object:os.system x"),
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
        6e6,
        1e8,
        1e300,
        "a" * 3000,
    ),
    *([], {}, [[]], [None], [1, 2], [1, 2, 3], ["a"], {"": 0}, {"x": 1, "y": 2}, [0] * 200, [[0.0, 0.0]] * 50, {"name": "dwa"}),
)
FAR = (6e6, -6e6, 1e8, 1e12, 1e300, np.inf, np.nan)  # one number far off among good ones
KINDS = ("f4", "f8", "i1", "i4", "i8", "u8", "?", "S3", "U2", "c16", "M8[s]")
SHAPES = ((), (0,), (1,), (3,), (2, 3), (0, 3), (1, 1, 1), (5, 2), (4, 4, 4))


@st.composite
def changed_bytes(draw: st.DrawFn, content: bytes) -> bytes:
    """Cut, doubled, overwritten and spliced bytes."""
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(content)))
        until = min(len(content), at + draw(st.integers(0, 40)))
        way = draw(st.integers(0, 5))
        new = draw(st.binary(max_size=12)) if way < 3 else draw(st.sampled_from((*WORDS, *NUMBERS))).encode("utf-8", "surrogatepass")
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
            parent[draw(st.sampled_from(("", "name", "x", "\n", "a" * 300)))] = parent.pop(key)
        elif way == 2 and isinstance(parent, list):
            parent.extend([parent[key]] * draw(st.sampled_from((1, 20, 300))))
        elif way == 3:
            parent[key] = [parent[key]]
        else:
            parent[key] = deepcopy(draw(st.sampled_from(VALUES)))
    return tree


def _places(tree: Any) -> Any:
    """Yield every (container, key) of a tree."""
    for key, value in list(tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()):
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
            one.set(draw(st.sampled_from(sorted(one.attrib))), draw(st.sampled_from((*NUMBERS, "", "1 2", "0 0 0 0 0 nan", "plane"))))
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
        way = draw(st.integers(0, 7))
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
            row[at] = draw(st.sampled_from((*NUMBERS, "", '"', '"a\nb"', "=1+1", "a" * 200, "goal_reached", "-5", "1.5")))
    return "\n".join(",".join(row) for row in rows).encode()
