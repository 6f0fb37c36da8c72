"""Counter-based random numbers: each is a pure function of (key, tick, index), so order and batch size cannot shift it.

Philox4x32-10 of Salmon, Moraes, Dror and Shaw, Parallel Random Numbers: As Easy as 1, 2, 3, SC 2011.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.scalars import Integer

_MULTIPLIER_0 = np.uint64(0xD2511F53)
_MULTIPLIER_1 = np.uint64(0xCD9E8D57)
_WEYL_0 = np.uint64(0x9E3779B9)
_WEYL_1 = np.uint64(0xBB67AE85)
_LOW = np.uint64(0xFFFFFFFF)
_HALF = np.uint64(32)
_NORMALS = np.uint64(0x80000000)  # set in the counter's last word: uniform and normal never share a block


@borrowing
def philox(
    c0: Integer, c1: Integer, c2: Integer, c3: Integer, k0: Integer, k1: Integer
) -> tuple[np.uint64, np.uint64, np.uint64, np.uint64]:
    """Return the four random 32-bit words (as uint64) of a counter of four and a key of two 32-bit words."""
    a, b, c, d = np.uint64(c0), np.uint64(c1), np.uint64(c2), np.uint64(c3)
    key_0, key_1 = np.uint64(k0), np.uint64(k1)
    for _ in range(10):
        product_0 = a * _MULTIPLIER_0
        product_1 = c * _MULTIPLIER_1
        a = (product_1 >> _HALF) ^ b ^ key_0
        b = product_1 & _LOW
        c = (product_0 >> _HALF) ^ d ^ key_1
        d = product_0 & _LOW
        key_0 = (key_0 + _WEYL_0) & _LOW
        key_1 = (key_1 + _WEYL_1) & _LOW
    return a, b, c, d


@borrowing
def _block(key: Integer, tick: Integer, index: Integer, domain: np.uint64) -> tuple[np.uint64, np.uint64, np.uint64, np.uint64]:
    k, t, i = np.uint64(key), np.uint64(tick), np.uint64(index)
    return philox(i & _LOW, i >> _HALF, t & _LOW, (t >> _HALF) ^ domain, k & _LOW, k >> _HALF)


@borrowing
def _unit(high: np.uint64, low: np.uint64) -> float:
    """Return a float in [0, 1) with 53 random bits."""
    return (float(high >> np.uint64(5)) * 67108864.0 + float(low >> np.uint64(6))) / 9007199254740992.0


@borrowing
def uniform(key: Integer, tick: Integer, index: Integer) -> float:
    """Return a uniform number in [0, 1)."""
    a, b, _, _ = _block(key, tick, index, np.uint64(0))
    return _unit(a, b)


@borrowing
def _normal_pair(key: Integer, tick: Integer, pair: Integer) -> tuple[float, float]:
    """Return two standard normal numbers (Box and Muller 1958)."""
    a, b, c, d = _block(key, tick, pair, _NORMALS)
    radius = np.sqrt(-2.0 * np.log(1.0 - _unit(a, b)))
    angle = 2.0 * np.pi * _unit(c, d)
    return radius * np.cos(angle), radius * np.sin(angle)


@borrowing
def normal(key: Integer, tick: Integer, index: Integer) -> float:
    """Return a standard normal number; indices 2 i and 2 i + 1 share one block."""
    first, second = _normal_pair(np.uint64(key), np.int64(tick), np.int64(index) >> 1)
    return second if np.int64(index) & 1 else first


@borrowing
def normals(key: Integer, tick: Integer, out: NDArray[np.float64]) -> None:
    """Fill ``out`` (K,) with ``normal(key, tick, 0 .. K - 1)``, at half the price."""
    for pair in range(len(out) // 2):
        out[2 * pair], out[2 * pair + 1] = _normal_pair(np.uint64(key), np.int64(tick), np.int64(pair))
    if len(out) % 2:
        out[-1] = normal(key, tick, len(out) - 1)
