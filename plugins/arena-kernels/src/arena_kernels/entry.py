"""Calls of kernels that do not look at their arguments' types."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, ParamSpec, TypeVar

from numba import typeof

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


class Entered(Generic[Arguments, Result]):
    """A kernel that is always called with arguments of the types of the first call: nothing checks them any more.

    numba tells the types anew before each call, which takes some 0.15 us for each number and array in named tuples, and more for tables
    with named fields: most of the time of a short kernel that takes a hundred of them. Who makes one vouches for the types: arrays that
    come from elsewhere are converted first. Whether an array can be written to does not matter.
    """

    def __init__(self, kernel: Callable[Arguments, Result]) -> None:
        self._kernel = kernel
        self._code: Callable[Arguments, Result] | None = None

    def __call__(self, *arguments: Arguments.args, **named: Arguments.kwargs) -> Result:
        """Call what the kernel is compiled to; arguments have no names here."""
        if self._code is None:
            dispatcher: Any = self._kernel
            self._code = dispatcher.compile(tuple(typeof(argument) for argument in arguments))  # type: ignore[no-untyped-call]
        return self._code(*arguments, **named)
