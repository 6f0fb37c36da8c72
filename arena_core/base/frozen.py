"""Arrays that nobody can write to, whoever holds them."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Scalar = TypeVar("Scalar", bound=np.generic)


def frozen(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """Return the array's values over immutable bytes, in C order; an array that has been frozen is returned as it is.

    A flag alone protects nothing: the owner of an array can set it back, and ``base`` leads to the owner.
    """
    if isinstance(array.base, bytes):
        return array
    values: NDArray[Any] = np.ndarray(array.shape, array.dtype, array.tobytes())
    return values
