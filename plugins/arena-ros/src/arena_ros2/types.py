"""Types of ROS 2 as DDS knows them, made of rosbags' descriptions; samples are the bytes themselves."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, cast

from cyclonedds.idl import make_idl_struct, types

from arena_ros.codec import get_codec

BASES: dict[str, Any] = {
    "bool": bool,
    "byte": types.uint8,
    "char": types.uint8,
    "octet": types.uint8,
    "string": str,
    **{
        name: getattr(types, name)
        for name in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")
    },
}


@lru_cache
def sample_type(name: str) -> Any:
    """Return the type of a topic's samples: ``content`` is the message as CDR, with its header of 4 bytes."""
    kind = _make_struct(name)
    kind.serialize = _serialize
    kind.deserialize = classmethod(_deserialize)
    return kind


def dds_name(name: str) -> str:
    """Return what DDS calls a type: ``sensor_msgs::msg::dds_::LaserScan_``."""
    package, _, own = name.partition("/msg/")
    return f"{package}::msg::dds_::{own}_"


def ros_name(name: str) -> str:
    """Return what ROS 2 calls a type of DDS; the name as it is where it is none of ROS."""
    package, between, own = name.partition("::msg::dds_::")
    return f"{package}/msg/{own.removesuffix('_')}" if between else name


def make_sample(kind: Any, content: bytes) -> Any:
    """Return a sample of these bytes."""
    made = object.__new__(kind)
    made.content = content
    return made


@lru_cache
def _nested_struct(name: str) -> Any:
    return _make_struct(name)


def _make_struct(name: str) -> Any:
    fields = {field: _field_annotation(kind) for field, kind in get_codec(2).store.fielddefs[name][1]}
    return make_idl_struct(name.replace("/", "_"), dds_name(name).replace("::", "."), fields)


def _field_annotation(kind: Any) -> Any:
    node, detail = kind
    if node.name == "BASE":
        return BASES[detail[0]]
    if node.name == "NAME":
        return _nested_struct(detail)
    inner = _field_annotation(detail[0])
    array, sequence = cast("Any", types.array), cast("Any", types.sequence)
    return array[inner, detail[1]] if node.name == "ARRAY" else sequence[inner]


def _serialize(self: Any, buffer: Any = None, endianness: Any = None, use_version_2: Any = None) -> bytes:
    content: bytes = self.content
    return content


def _deserialize(kind: Any, data: bytes, has_header: bool = True, use_version_2: Any = None) -> Any:
    return make_sample(kind, bytes(data))
