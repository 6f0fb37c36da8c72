"""Files that anybody may have written: read within limits, and whatever is wrong with one is one line."""

from __future__ import annotations

import csv
import gzip
import io
import json
import stat
import zlib
from collections.abc import Hashable
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any

from arena_core.base.confinement import is_readable
from arena_core.base.errors import InputFileError, one_line
from arena_core.base.limits import LIMITS

if TYPE_CHECKING:
    import yaml

AnyPath = str | Path
QUOTED = 120  # characters of a reason
PART = 2**20  # bytes
BRACKETS = {ord("["): 1, ord("{"): 1, ord("]"): -1, ord("}"): -1}


def read_bytes(path: AnyPath, largest: int, allowed: str, *, unpack: bool = True) -> bytes:
    """Return a file's content; raise InputFileError, which names ``allowed`` as what may be there.

    A file whose name ends in .gz is unpacked unless that is not wanted.

    More than ``largest`` bytes are refused, and so is what is no file: a folder, a pipe that would be waited for, a
    device without end.
    """
    path = Path(path)
    packed = unpack and path.suffix == ".gz"
    if not is_readable(path):
        raise InputFileError(
            f"{path}: lies outside the folder that is served, or leads out of it; allowed: a file in it"
        )
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise InputFileError(f"{path}: cannot be read (it is no file); allowed: {allowed}")
        if not packed and status.st_size > largest:
            raise _too_large(path, largest)
        content = _read_content(path, largest + 1, packed=packed)
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise InputFileError(f"{path}: is no gzip file ({reason_of(error)}); allowed: {allowed}") from None
    except (OSError, ValueError) as error:  # ValueError: a name with a null in it
        reason = getattr(error, "strerror", None) or reason_of(error)
        raise InputFileError(f"{path}: cannot be read ({reason}); allowed: {allowed}") from None
    if len(content) > largest:
        raise _too_large(path, largest)
    return content


def is_file(path: AnyPath) -> bool:
    """Return whether a file is there and may be read; not where no file can be, by a name that
    is too long or has a NUL in it.
    """
    try:
        return is_readable(Path(path)) and Path(path).is_file()
    except (OSError, ValueError):
        return False


def read_text(path: AnyPath, largest: int, allowed: str) -> str:
    """Return a file's text, UTF-8 with or without a byte order mark; raise InputFileError."""
    try:
        return read_bytes(path, largest, allowed).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputFileError(f"{path}: is no text in UTF-8 ({reason_of(error)}); allowed: {allowed}") from None


def read_json(path: AnyPath, allowed: str) -> Any:
    """Return what a JSON file holds; raise InputFileError for anything else, a key
    that is there twice and NaN among it.
    """
    text = read_text(path, LIMITS.json_bytes, allowed)
    try:
        return json.loads(text, object_pairs_hook=_unique_pairs, parse_constant=_no_constant)
    except json.JSONDecodeError as error:
        raise InputFileError(
            f"{path}: is no JSON (line {error.lineno}, column {error.colno}: {error.msg}); allowed: {allowed}"
        ) from None
    # ValueError: what the two functions below refuse, and numbers of thousands of digits; RecursionError: nested
    # without end
    except (ValueError, RecursionError) as error:
        raise InputFileError(f"{path}: is no JSON ({reason_of(error)}); allowed: {allowed}") from None


def read_yaml(path: AnyPath, allowed: str) -> Any:
    """Return what a YAML file holds; raise InputFileError for anything else, aliases and a key
    that is there twice among it.
    """
    import yaml

    content = read_bytes(path, LIMITS.yaml_bytes, allowed)
    if (
        max(accumulate(BRACKETS.get(byte, 0) for byte in content), default=0) > LIMITS.yaml_depth
    ):  # PyYAML would take seconds for each thousand
        raise InputFileError(
            f"{path}: is no YAML (it nests deeper than {LIMITS.yaml_depth} brackets); allowed: {allowed}"
        )
    try:
        return yaml.load(content, _safe_loader())  # noqa: S506 - it is a SafeLoader
    # PyYAML lets through whatever its constructors stumble over: KeyError, IndexError, AttributeError, ...
    except Exception as error:
        mark = getattr(error, "problem_mark", None)
        place = f"line {mark.line + 1}: " if mark is not None else ""
        raise InputFileError(f"{path}: is no YAML ({place}{reason_of(error)}); allowed: {allowed}") from None


def read_table(path: AnyPath, allowed: str) -> tuple[list[str], list[dict[str, str]]]:
    """Return the columns and rows of a CSV file; raise InputFileError, also for a
    row of another length than the first.
    """
    text = read_text(path, LIMITS.table_bytes, allowed)
    try:
        reader = csv.DictReader(io.StringIO(text, newline=""), strict=True)
        columns, rows = list(reader.fieldnames or []), list[dict[str, str]]()
        for row in reader:
            if None in row or None in row.values():
                raise InputFileError(f"{path}: line {reader.line_num} has another number of fields than the header")
            rows.append(row)
    except csv.Error as error:
        raise InputFileError(f"{path}: is no table ({reason_of(error)}); allowed: {allowed}") from None
    return columns, rows


def check_inside(folder: AnyPath, path: AnyPath) -> None:
    """Raise InputFileError where a path leads out of a folder, by .. or by a link."""
    try:
        real, root = Path(path).resolve(), Path(folder).resolve()
    except (OSError, ValueError, RuntimeError) as error:  # RuntimeError: links in a circle; ValueError: a null
        raise InputFileError(f"{path}: cannot be found ({reason_of(error)}); allowed: a file inside {folder}") from None
    if not real.is_relative_to(root):
        raise InputFileError(f"{path}: leads out of {folder}; allowed: files inside it")


def reason_of(error: BaseException) -> str:
    """Return what an error says, on one line and not for ever."""
    said = str(getattr(error, "problem", None) or error)
    tells_little = not said or isinstance(error, (LookupError, AttributeError, TypeError))
    return one_line(f"{type(error).__name__}: {said}".removesuffix(": ") if tells_little else said, QUOTED)


def _read_content(path: Path, most: int, *, packed: bool) -> bytes:
    """Read up to so many bytes, in parts: one read would first make room for all of them."""
    parts, left = list[bytes](), most
    with gzip.open(path) if packed else path.open("rb") as file:
        while left > 0 and (part := file.read(min(left, PART))):
            parts.append(part)
            left -= len(part)
    return b"".join(parts)


def _too_large(path: Path, largest: int) -> InputFileError:
    return InputFileError(
        f"{path}: is larger than {largest} bytes{' unpacked' if path.suffix == '.gz' else ''}; allowed: up to that"
    )


def _unique_pairs(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    mapping = dict(pairs)
    if len(mapping) < len(pairs):
        raise ValueError(
            f"a key is there twice among {', '.join(one_line(name, QUOTED) for name, _ in pairs[:QUOTED])}"
        )
    return mapping


def _no_constant(name: str) -> Any:
    raise ValueError(f"{name} is no number of JSON")


def _safe_loader() -> type[yaml.SafeLoader]:
    import yaml

    class PlainLoader(yaml.SafeLoader):
        """A safe loader without aliases, which make a short file's values endless, and without
        keys that are there twice.
        """

        def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
            """Refuse an alias."""
            if self.check_event(yaml.AliasEvent):
                raise yaml.YAMLError("it has aliases")
            return super().compose_node(parent, index)

        def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
            """Refuse a key that is there twice: a plain loader takes the last one."""
            keys = set[Hashable]()
            for key, _ in node.value if isinstance(node, yaml.MappingNode) else ():
                name = self.construct_object(key, deep=True)
                if not isinstance(name, Hashable):
                    raise yaml.YAMLError(f"a key is a {type(name).__name__}, line {key.start_mark.line + 1}")
                if name in keys:
                    raise yaml.YAMLError(f"{name} is there twice, line {node.start_mark.line + 1}")
                keys.add(name)
            return super().construct_mapping(node, deep)

    return PlainLoader
