import math
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from arena_core.parameters import Bounds, Fraction, NonNegative, NonNegativeInt, Positive, PositiveInt

numbers = st.floats(-10.0, 10.0)


@given(low=numbers, high=numbers, above=numbers, value=numbers)
def test_low_and_high_are_allowed_and_above_is_not(low, high, above, value):
    assert Bounds(low, high, above).allows(value) == (low <= value <= high and value > above)


@pytest.mark.parametrize("bounds", [Bounds(), Bounds(low=0.0), Bounds(high=1.0), Bounds(above=0.0)])
def test_nan_is_never_allowed(bounds):
    assert not bounds.allows(math.nan)


@pytest.mark.parametrize(
    ("kind", "number", "possible", "impossible"),
    [
        (Positive, float, 1e-9, 0.0),
        (NonNegative, float, 0.0, -1e-9),
        (Fraction, float, 1.0, 1.1),
        (PositiveInt, int, 1, 0),
        (NonNegativeInt, int, 0, -1),
    ],
)
def test_named_types_hold_what_they_say(kind, number, possible, impossible):
    annotation, bounds = get_args(kind)
    assert annotation is number
    assert bounds.allows(possible)
    assert not bounds.allows(impossible)


@pytest.mark.parametrize(
    ("bounds", "text"),
    [
        (Bounds(above=0.0), "> 0"),
        (Bounds(above=0.0, high=2.5), "> 0 and <= 2.5"),
        (Bounds(low=1.0), ">= 1"),
        (Bounds(low=0.0, high=1.0), "0 .. 1"),
        (Bounds(high=0.0), "<= 0"),
    ],
)
def test_bounds_say_what_is_allowed(bounds, text):
    assert str(bounds) == text
