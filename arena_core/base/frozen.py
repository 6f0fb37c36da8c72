"""Arrays that no one can write to, whoever holds them."""

from __future__ import annotations

import ctypes
import mmap
import sys
from contextlib import suppress
from functools import cache
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from arena_core.base.portability import PORTABLE

Scalar = TypeVar("Scalar", bound=np.generic)


def freeze_array(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """Return the array's values over immutable bytes, in C order; an array that has been frozen is returned as it is.

    A flag alone protects nothing: the owner of an array can set it back, and ``base`` leads to the owner.
    """
    if isinstance(array.base, bytes) or is_sealed(array):
        return array
    values: NDArray[Any] = np.ndarray(array.shape, array.dtype, array.tobytes())
    return values


def seal_array(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """Return the array's values over memory that the kernel lets no one write to, compiled code neither; frozen where
    it cannot.

    For what outlives an episode. It takes whole pages, so what is made at every control step is only frozen.
    """
    if is_sealed(array) or array.size == 0:
        return freeze_array(array)
    if sys.platform != "win32" and not PORTABLE:
        with suppress(OSError, ValueError):  # no room for more mappings
            values: NDArray[Any] = np.ndarray(array.shape, array.dtype, _read_only(array.tobytes()))
            return values
    return freeze_array(array)


def is_sealed(array: NDArray[Any]) -> bool:
    """Return whether an array lies over memory that no one can write to."""
    return isinstance(array.base, mmap.mmap) and memoryview(array.base).readonly


if sys.platform != "win32":  # Windows has no such pages

    def _read_only(content: bytes) -> mmap.mmap:
        """Return bytes in pages of their own that can only be read."""
        pages = mmap.mmap(-1, len(content), mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, mmap.PROT_READ)
        begin = np.frombuffer(pages, np.uint8).ctypes.data
        _protect_memory(begin, len(content), mmap.PROT_READ | mmap.PROT_WRITE)
        ctypes.memmove(begin, content, len(content))
        _protect_memory(begin, len(content), mmap.PROT_READ)
        return pages

    @cache
    def _c_library() -> ctypes.CDLL:
        """Return the C library; each new handle makes a class, which takes a millisecond."""
        return ctypes.CDLL(None, use_errno=True)

    def _protect_memory(begin: int, length: int, protection: int) -> None:
        if _c_library().mprotect(ctypes.c_void_p(begin), ctypes.c_size_t(length), protection):
            raise OSError(ctypes.get_errno(), "mprotect")
