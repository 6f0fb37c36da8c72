"""YAML whose every value knows its file and key, as json_fields has it for JSON."""

from __future__ import annotations

from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from arena_core import InputFileError
from arena_tasks.json_fields import Field

LARGEST_FILE = 1_000_000  # bytes


class PlainLoader(yaml.SafeLoader):
    """A safe loader without aliases, which make a short file's values endless, and without keys that are there twice."""

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        """Refuse an alias."""
        if self.check_event(yaml.AliasEvent):
            raise yaml.YAMLError("it has aliases")
        return super().compose_node(parent, index)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        """Refuse a key that is there twice: a plain loader takes the last one."""
        keys = [self.construct_object(key, deep=True) for key, _ in node.value]
        twice = [key for number, key in enumerate(keys) if key in keys[:number]]
        if twice:
            raise yaml.YAMLError(f"{twice[0]} is there twice, line {node.start_mark.line + 1}")
        return super().construct_mapping(node, deep)


def read_yaml(path: Path, allowed: str) -> Field:
    """Read a YAML file; raise InputFileError, which names ``allowed`` as what may be there."""
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise ValueError(f"it is larger than {LARGEST_FILE} bytes")
        return Field(path, "", yaml.load(content, PlainLoader))  # noqa: S506 - PlainLoader is a SafeLoader
    except OSError as error:
        raise InputFileError(f"{path}: cannot be read ({error.strerror}); allowed: {allowed}") from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise InputFileError(f"{path}: is no YAML ({' '.join(str(error).split())}); allowed: {allowed}") from None
