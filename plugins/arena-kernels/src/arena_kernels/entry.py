"""Calls of kernels that do not look at their arguments' types."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import typeof


def entered(kernel: Callable[..., Any], *arguments: Any) -> Callable[..., Any]:
    """Return what a kernel is compiled to for arguments of these types, to be called with such arguments only: nothing checks them.

    numba tells the types anew before each call, which takes some 0.15 us for each number and array in named tuples: most of the time
    of a short kernel that takes a hundred of them.
    """
    dispatcher: Any = kernel
    types = tuple(typeof(argument) for argument in arguments)  # type: ignore[no-untyped-call]
    code: Callable[..., Any] = dispatcher.compile(types)
    return code
