"""Values of a YAML file that are changed in its text, so that comments, order and spelling of all else stay."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, TypeAlias

import yaml

from arena_core import InputFileError
from arena_core.commands import one_line

Value: TypeAlias = str | float | list[float]
SHORT = 15  # digits: as many as a float always keeps


def with_values(text: str, values: Mapping[str, Value], name: str) -> str:
    """Return the text with other values of keys that it has; raise InputFileError, which calls the file ``name``, for
    one that it has not.

    Keys may stand at the top or below others, as ``/**: ros__parameters:`` of files for ROS 2.
    """
    places: list[tuple[int, int, str]] = []
    nodes = _value_nodes(_compose_yaml(text, name))
    for key, value in values.items():
        if key not in nodes:
            raise InputFileError(f"{name}: {key} is missing; allowed: a map's YAML file")
        places += _text_places(nodes[key], value, f"{name}: {key}")
    for begin, end, written in sorted(places, reverse=True):
        text = text[:begin] + written + text[end:]
    return text


def _compose_yaml(text: str, name: str) -> Any:
    try:
        return yaml.compose(text, yaml.SafeLoader)
    except yaml.YAMLError as error:
        raise InputFileError(f"{name}: is no YAML ({one_line(str(error), 120)}); allowed: a map's YAML file") from None


def _value_nodes(node: Any) -> dict[str, Any]:
    """Return the nodes of values by key; of keys with the same name the outermost one."""
    if not isinstance(node, yaml.MappingNode):
        return {}
    found: dict[str, Any] = {}
    for _, value in node.value:
        found.update(_value_nodes(value))
    return {**found, **{key.value: value for key, value in node.value}}


def _text_places(node: Any, value: Value, name: str) -> list[tuple[int, int, str]]:
    """Return where in the text a value begins and ends, and what it will be; of a list, for each item."""
    if not isinstance(value, list):
        written = json.dumps(value, ensure_ascii=False) if isinstance(value, str) else _format_number(value)
        return [(node.start_mark.index, node.end_mark.index, written)]
    if not isinstance(node, yaml.SequenceNode) or len(node.value) != len(value):
        raise InputFileError(f"{name} is no list of {len(value)} numbers; allowed: a map's YAML file")
    return [place for item, number in zip(node.value, value, strict=True) for place in _text_places(item, number, name)]


def _format_number(value: float) -> str:
    """Return a number as ROS and YAML 1.1 read it: with a point, for 5e-2 is a text in YAML."""
    short = f"{value:.{SHORT}g}"
    text = short if float(short) == value else repr(float(value))
    mantissa, _, exponent = text.partition("e")
    if "." not in mantissa:
        mantissa += ".0"
    return (
        f"{mantissa}e{exponent if exponent.startswith('-') else '+' + exponent.lstrip('+')}" if exponent else mantissa
    )
