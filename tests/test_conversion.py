import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from arena_core import ConfigurationError, Planner, Robot
from arena_core.config.binding import build_component, convert_value, parameter_types
from arena_core.parameters import Bounds, Flat, Positive, PositiveInt
from arena_core.testing import robot


def nothing_nested(annotation, value, key, context):
    return NotImplemented


def converted(value, annotation):
    return convert_value(value, annotation, "planner.x", {}, nothing_nested)


@dataclass(frozen=True)
class Weights:
    path: Positive
    goal: float


@dataclass(frozen=True)
class Settings:
    weights: Weights
    mode: Literal["fast", "slow"]


class Thing:
    def __init__(self, robot: Robot, speed: Positive | None, samples: PositiveInt, weights: Weights) -> None:
        self.given = (robot, speed, samples, weights)


NODE = {"name": "thing", "speed": 0.5, "samples": 20, "weights": {"path": 32, "goal": 20.0}}


@pytest.mark.parametrize(
    ("value", "annotation", "result"),
    [
        (1, float, 1.0),
        (0.5, Positive, 0.5),
        (3, int, 3),
        (True, bool, True),
        ("a", str, "a"),
        (None, float | None, None),
        (2, float | None, 2.0),
        (0.2, Positive | None, 0.2),
        ("auto", Positive | Literal["auto"], "auto"),
        ("slow", Literal["fast", "slow"], "slow"),
        ([1, 2.5], list[float], [1.0, 2.5]),
        ([[0, 1], [2, 3]], list[list[float]], [[0.0, 1.0], [2.0, 3.0]]),
        ([1], Sequence[float], [1.0]),
        ({"a": 1}, dict[str, float], {"a": 1.0}),
        ({"a": 1}, Mapping[str, int], {"a": 1}),
        ({"path": 1, "goal": -1}, Weights, Weights(1.0, -1.0)),
        (Weights(1.0, 2.0), Weights, Weights(1.0, 2.0)),
        ({"weights": {"path": 1, "goal": 2}, "mode": "fast"}, Settings, Settings(Weights(1.0, 2.0), "fast")),
        ({"anything": [1]}, Any, {"anything": [1]}),
    ],
)
def test_a_possible_value_becomes_what_the_constructor_asks_for(value, annotation, result):
    assert converted(value, annotation) == result
    assert type(converted(value, annotation)) is type(result)


@pytest.mark.parametrize(
    ("value", "annotation", "message"),
    [
        ("fast", float, r"planner.x is 'fast'; allowed: a number"),
        (True, float, r"planner.x is True; allowed: a number"),
        (math.nan, float, r"planner.x is nan; allowed: a number"),
        (math.nan, Positive, r"planner.x is nan; allowed: a number"),
        (None, float, r"planner.x is None; allowed: a number"),
        (0, Positive, r"planner.x is 0; allowed: > 0"),
        (-1.0, Positive | None, r"planner.x is -1.0; allowed: > 0"),
        (1.5, Annotated[float, Bounds(low=0.0, high=1.0)], r"planner.x is 1.5; allowed: 0 .. 1"),
        (1.5, int, r"planner.x is 1.5; allowed: a whole number"),
        (True, int, r"planner.x is True; allowed: a whole number"),
        (0, PositiveInt, r"planner.x is 0; allowed: >= 1"),
        (1, bool, r"planner.x is 1; allowed: true or false"),
        ("yes", bool, r"planner.x is 'yes'; allowed: true or false"),
        (1, str, r"planner.x is 1; allowed: a text"),
        ("quick", Literal["fast", "slow"], r"planner.x is 'quick'; allowed: one of fast, slow"),
        (True, Literal[1, 2], r"planner.x is True; allowed: one of 1, 2"),
        (1.0, list[float], r"planner.x is 1.0; allowed: a list"),
        ("abc", list[str], r"planner.x is 'abc'; allowed: a list"),
        ([1.0, "a"], list[float], r"planner.x\[1\] is 'a'; allowed: a number"),
        ([1.0], dict[str, float], r"planner.x is \[1.0\]; allowed: a mapping"),
        ({"a": "b"}, dict[str, float], r"planner.x.a is 'b'; allowed: a number"),
        (3, Weights, r"planner.x is 3; allowed: a mapping with path, goal"),
        ({"path": 1}, Weights, r"planner.x lacks goal"),
        (
            {"path": 1, "goal": 1, "gaol": 2},
            Weights,
            r"planner.x has no parameter gaol; did you mean goal\? \(allowed: path, goal\)",
        ),
        ({"path": 0, "goal": 1}, Weights, r"planner.x.path is 0; allowed: > 0"),
        (
            {"weights": {"path": 1, "goal": "far"}, "mode": "fast"},
            Settings,
            r"planner.x.weights.goal is 'far'; allowed: a number",
        ),
        ("robot", Robot, r"planner.x is 'robot'; allowed: a mapping with name"),
        (3, Planner, r"planner.x is 3; allowed: a Planner"),
    ],
)
def test_an_impossible_value_names_the_key_and_what_is_allowed(value, annotation, message):
    with pytest.raises(ConfigurationError, match=f"^{message}") as caught:
        converted(value, annotation)
    assert "\n" not in str(caught.value)


@given(
    value=st.one_of(
        st.none(),
        st.booleans(),
        st.integers(),
        st.floats(),
        st.text(),
        st.lists(st.integers()),
        st.dictionaries(st.text(), st.none()),
    )
)
def test_whatever_comes_is_either_a_positive_number_or_refused(value):
    try:
        result = converted(value, Positive)
    except ConfigurationError:
        return
    assert isinstance(result, float)
    assert result > 0.0


def test_building_passes_the_context_that_the_constructor_names():
    body = robot()
    thing = build_component(Thing, NODE, "planner", {"robot": body, "world": "not asked for"}, nothing_nested)
    assert thing.given == (body, 0.5, 20, Weights(32.0, 20.0))


def test_a_function_is_a_factory_too_and_may_ask_for_the_name():
    def make(name: str, size: Positive) -> tuple[str, float]:
        return name, size

    assert build_component(make, {"name": "big", "size": 2}, "world", {}, nothing_nested) == ("big", 2.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"sped": 1.0}, r"planner has no parameter sped; did you mean speed\? \(allowed: speed, samples, weights\)"),
        ({"colour": 1.0}, r"planner has no parameter colour \(allowed: speed, samples, weights\)"),
        ({"robot": {}}, r"planner has no parameter robot"),
        ({"weights": {"path": 1}}, r"planner.weights lacks goal"),
        ({"samples": 0}, r"planner.samples is 0; allowed: >= 1"),
    ],
)
def test_an_unknown_or_impossible_key_of_a_component_is_named(change, message):
    with pytest.raises(ConfigurationError, match=f"^{message}"):
        build_component(Thing, NODE | change, "planner", {"robot": robot()}, nothing_nested)


def test_a_missing_key_is_named():
    with pytest.raises(ConfigurationError, match=r"^planner lacks speed, samples$"):
        build_component(Thing, {"weights": NODE["weights"]}, "planner", {"robot": robot()}, nothing_nested)


def test_what_has_a_default_may_be_left_out():
    class Old:
        def __init__(self, robot: Robot, speed: float, turn: float = 2.0) -> None:
            self.values = speed, turn

    given = {"robot": robot()}
    assert build_component(Old, {"name": "old", "speed": 1.0}, "planner", given, nothing_nested).values == (1.0, 2.0)
    assert build_component(Old, {"name": "old", "speed": 1.0, "turn": 3}, "planner", given, nothing_nested).values == (
        1.0,
        3.0,
    )
    with pytest.raises(ConfigurationError, match=r"^planner lacks speed$"):
        build_component(Old, {"turn": 3.0}, "planner", given, nothing_nested)


def test_a_component_without_parameters_says_so():
    class Plain:
        pass

    with pytest.raises(ConfigurationError, match=r"has no parameter size \(allowed: none\)"):
        build_component(Plain, {"size": 1}, "tracker", {}, nothing_nested)


def test_parameters_keep_their_bounds():
    assert parameter_types(Thing)["samples"] == PositiveInt
    assert list(parameter_types(Thing)) == ["robot", "speed", "samples", "weights"]


@dataclass(frozen=True)
class Sampling:
    batch: PositiveInt
    spread: float = 0.5


class Grouped:
    def __init__(self, robot: Robot, sampling: Annotated[Sampling, Flat()], speed: float) -> None:
        self.robot, self.sampling, self.speed = robot, sampling, speed


def grouped(**node):
    return build_component(Grouped, node, "planner", {"robot": robot()}, lambda *_: NotImplemented)


def test_fields_of_a_flat_record_are_keys_beside_the_others():
    built = grouped(batch=3, spread=0.1, speed=1.0)
    assert (built.sampling, built.speed) == (Sampling(3, 0.1), 1.0)
    assert grouped(batch=3, speed=1.0).sampling == Sampling(3)
    assert list(parameter_types(Grouped)) == ["robot", "batch", "spread", "speed"]
    for node, said in (
        ({"speed": 1.0}, "planner lacks batch"),
        ({"batch": 0, "speed": 1.0}, r"planner\.batch is 0; allowed: >= 1"),
        ({"batch": 1, "speed": 1.0, "sampling": {"batch": 1}}, "planner has no parameter sampling"),
    ):
        with pytest.raises(ConfigurationError, match=said):
            grouped(**node)
