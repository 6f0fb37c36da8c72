"""How kernels are compiled."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

Kernel = TypeVar("Kernel", bound=Callable[..., Any])


def compiled(kernel: Kernel) -> Kernel:
    """Compile a kernel.

    A division that cannot raise lets the compiler drop much of the reference counting of array arguments.
    """
    return njit(cache=True, error_model="numpy")(kernel)  # type: ignore[return-value]


def borrowing(kernel: Kernel) -> Kernel:
    """Compile a kernel that only borrows arrays and makes none, without any reference counting.

    Counting is atomic, and was most of the time of short kernels that take whole named tuples of arrays. numba refuses to compile
    an allocation here.
    """
    return njit(cache=True, error_model="numpy", _nrt=False)(kernel)  # type: ignore[call-overload, no-any-return]
