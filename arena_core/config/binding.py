"""Turn configuration nodes into constructor arguments, checking every key, type and bound on the way."""

from __future__ import annotations

import dataclasses
import inspect
import reprlib
import types
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from arena_core.base.errors import ConfigurationError
from arena_core.base.hints import did_you_mean
from arena_core.base.limits import LIMITS
from arena_core.values.parameters import Bounds, Flat

Record = TypeVar("Record")
NUMBERS = f"a number up to {LIMITS.number_largest:g}, of either sign"
DIVISORS = f"> 0, and {LIMITS.number_smallest:g} at least"
WHOLES = f"a whole number up to {LIMITS.whole_largest}"
Nested = Callable[[Any, Any, str, Mapping[str, Any]], Any]


def build_component(
    factory: Callable[..., Any], node: Mapping[str, Any], key: str, context: Mapping[str, Any], nested: Nested
) -> Any:
    """Call ``factory`` with the values of ``node`` and those of ``context`` that its signature names.

    ``key`` is the node's place in the configuration (empty for its top), for messages. ``nested`` builds components
    inside components. What has a default in the signature may be left out: cards of policies are older than some
    parameters of their encoders.
    """
    expected = parameter_types(factory)
    given = bind_arguments(factory, node, key, context, nested)
    given |= {name: value for name, value in context.items() if name in expected}
    return factory(**_group_values(factory, given))


def bind_arguments(
    factory: Callable[..., Any], node: Mapping[str, Any], key: str, context: Mapping[str, Any], nested: Nested
) -> dict[str, Any]:
    """Return what ``build_component`` would take from ``node``, converted; raise ConfigurationError as it does."""
    expected = parameter_types(factory)
    given = {name: value for name, value in node.items() if name != "name" or "name" in expected}
    own = {name: annotation for name, annotation in expected.items() if name not in context}
    _check_keys(given, own, _optional_ones(factory), key)
    return {
        name: convert_value(given[name], expected[name], f"{key}.{name}".lstrip("."), context, nested)
        for name in own
        if name in given
    }


def read_settings(node: Any, record: type[Record], key: str) -> Record:
    """Return the frozen dataclass ``record`` from a configuration node that holds no components;
    raise ConfigurationError.
    """
    settings: Record = convert_value(node, record, key, {}, lambda *_: NotImplemented)
    return settings


@lru_cache(maxsize=512)
def parameter_types(factory: Callable[..., Any]) -> Mapping[str, Any]:
    """Return the annotation of each parameter of a constructor or function; flat records are their fields."""
    found: dict[str, Any] = {}
    for name, annotation in _own_types(factory).items():
        record = _flat_record(annotation)
        found |= parameter_types(record) if record else {name: annotation}
    return found


def _own_types(factory: Callable[..., Any]) -> dict[str, Any]:
    function = factory.__init__ if inspect.isclass(factory) else factory
    hints = get_type_hints(function, include_extras=True)
    return {name: hints.get(name, Any) for name in inspect.signature(factory).parameters}


def _flat_record(annotation: Any) -> Any:
    """Return the record that an annotation marks as flat, None for every other annotation."""
    marks = get_args(annotation) if get_origin(annotation) is Annotated else ()
    return marks[0] if any(isinstance(mark, Flat) for mark in marks) else None


def _group_values(factory: Callable[..., Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return values by parameter, with those of flat records put into them."""
    grouped = {}
    for name, annotation in _own_types(factory).items():
        if record := _flat_record(annotation):
            own = {field: values[field] for field in parameter_types(record) if field in values}
            grouped[name] = record(**_group_values(record, own))
        elif name in values:
            grouped[name] = values[name]
    return grouped


@lru_cache(maxsize=512)
def _optional_ones(factory: Callable[..., Any]) -> frozenset[str]:
    """Return the parameters that have a default."""
    flat = [record for annotation in _own_types(factory).values() if (record := _flat_record(annotation))]
    return frozenset(
        name for name, p in inspect.signature(factory).parameters.items() if p.default is not inspect.Parameter.empty
    ).union(*map(_optional_ones, flat))


def convert_value(value: Any, annotation: Any, key: str, context: Mapping[str, Any], nested: Nested) -> Any:
    """Return ``value`` as ``annotation`` wants it; raise ConfigurationError with the key and what is allowed."""
    component = nested(annotation, value, key, context)
    if component is not NotImplemented:
        return component
    origin, arguments = get_origin(annotation), get_args(annotation)
    if annotation is Any:
        return value
    if origin is Annotated:
        return _convert_bounded(value, arguments, key, context, nested)
    if origin is Literal:
        return _check_value(
            value,
            key,
            "one of " + ", ".join(map(str, arguments)),
            possible=any(value == a and type(value) is type(a) for a in arguments),
        )
    if origin in (Union, types.UnionType):
        return _convert_optional(value, arguments, key, context, nested)
    if dataclasses.is_dataclass(annotation):
        return _convert_record(value, annotation, key, context, nested)
    if origin in (list, tuple, Sequence):
        _check_value(value, key, "a list", possible=isinstance(value, (list, tuple)))
        return [convert_value(v, arguments[0], f"{key}[{i}]", context, nested) for i, v in enumerate(value)]
    if origin in (dict, Mapping):
        _check_value(value, key, "a mapping", possible=isinstance(value, Mapping))
        return {str(k): convert_value(v, arguments[1], f"{key}.{k}", context, nested) for k, v in value.items()}
    return _convert_scalar(value, annotation, key)


def _convert_bounded(
    value: Any, arguments: tuple[Any, ...], key: str, context: Mapping[str, Any], nested: Nested
) -> Any:
    converted = convert_value(value, arguments[0], key, context, nested)
    for bounds in arguments[1:]:
        if isinstance(bounds, Bounds):
            _check_value(value, key, str(bounds), possible=bounds.allows(converted))
            _check_value(value, key, DIVISORS, possible=bounds.above != 0.0 or converted >= LIMITS.number_smallest)
    return converted


def _convert_optional(
    value: Any, arguments: tuple[Any, ...], key: str, context: Mapping[str, Any], nested: Nested
) -> Any:
    if value is None and type(None) in arguments:
        return None
    choices = [a for a in arguments if a is not type(None)]
    for choice in choices[:-1]:
        try:
            return convert_value(value, choice, key, context, nested)
        except ConfigurationError:
            continue
    return convert_value(value, choices[-1], key, context, nested)


def _convert_record(value: Any, annotation: Any, key: str, context: Mapping[str, Any], nested: Nested) -> Any:
    if isinstance(value, annotation):
        return value
    _check_value(
        value,
        key,
        "a mapping with " + ", ".join(f.name for f in dataclasses.fields(annotation)),
        possible=isinstance(value, Mapping),
    )
    return build_component(annotation, value, key, {}, nested)


def _convert_scalar(value: Any, annotation: Any, key: str) -> Any:
    if annotation is float:
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        _check_value(value, key, "a number", possible=number and value == value)
        return float(_check_value(value, key, NUMBERS, possible=abs(value) <= LIMITS.number_largest))
    if annotation is int:
        _check_value(value, key, "a whole number", possible=isinstance(value, int) and not isinstance(value, bool))
        return _check_value(value, key, WHOLES, possible=abs(value) <= LIMITS.whole_largest)
    if annotation in (str, bool):
        return _check_value(
            value, key, {str: "a text", bool: "true or false"}[annotation], possible=isinstance(value, annotation)
        )
    if isinstance(annotation, type):
        return _check_value(value, key, f"a {annotation.__name__}", possible=isinstance(value, annotation))
    return value


def _check_value(value: Any, key: str, allowed: str, *, possible: bool) -> Any:
    if not possible:
        raise ConfigurationError(f"{key} is {reprlib.repr(value)}; allowed: {allowed}")
    return value


def _check_keys(given: Mapping[str, Any], expected: Mapping[str, Any], optional: frozenset[str], key: str) -> None:
    for name in given:
        if name not in expected:
            hint = did_you_mean(str(name), expected, _nested_keys(expected))
            raise ConfigurationError(f"{key} has no parameter {name}{hint} (allowed: {', '.join(expected) or 'none'})")
    missing = [name for name in expected if name not in given and name not in optional]
    if missing:
        raise ConfigurationError(f"{key} lacks {', '.join(missing)}")


def _nested_keys(expected: Mapping[str, Any], levels: int = 3) -> Iterator[str]:
    """Yield the keys of the records among parameters, with those that lead there, so many levels down."""
    for name, annotation in expected.items():
        for record in (
            one for one in (annotation, *get_args(annotation)) if dataclasses.is_dataclass(one) and inspect.isclass(one)
        ):
            inner = parameter_types(record)
            yield from (f"{name}.{key}" for key in (*inner, *(_nested_keys(inner, levels - 1) if levels else ())))
