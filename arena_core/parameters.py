"""Types that hold a component's configured values to a range, and the reader that checks a mapping against them."""

from arena_core.config.binding import read_settings
from arena_core.values.parameters import (
    Bounds,
    Count,
    Flat,
    Fraction,
    Horizon,
    NonNegative,
    NonNegativeInt,
    Positive,
    PositiveInt,
    Samples,
    Step,
    Workers,
)

__all__ = [
    "Bounds",
    "Count",
    "Flat",
    "Fraction",
    "Horizon",
    "NonNegative",
    "NonNegativeInt",
    "Positive",
    "PositiveInt",
    "Samples",
    "Step",
    "Workers",
    "read_settings",
]
