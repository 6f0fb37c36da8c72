"""Counter-based random numbers: each is a pure function of (key, tick, index), so order and batch size cannot shift it.

Philox4x32-10 of Salmon, Moraes, Dror and Shaw, Parallel Random Numbers: As Easy as 1, 2, 3, SC 2011.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inlined, inner
from arena_kernels.scalars import Integer

Words = tuple[np.uint64, np.uint64, np.uint64, np.uint64]

_MULTIPLIER_0 = np.uint64(0xD2511F53)
_MULTIPLIER_1 = np.uint64(0xCD9E8D57)
_WEYL_0 = np.uint64(0x9E3779B9)
_WEYL_1 = np.uint64(0xBB67AE85)
_LOW = np.uint64(0xFFFFFFFF)
_HALF = np.uint64(32)
_MIDDLE = 0.425  # beyond it the normal quantile needs a logarithm
_NORMALS = np.uint64(0x80000000)  # set in the counter's last word: uniform and normal never share a block


@inlined
def philox(c0: Integer, c1: Integer, c2: Integer, c3: Integer, k0: Integer, k1: Integer) -> Words:
    """Return the four random 32-bit words (as uint64) of a counter of four and a key of two 32-bit words."""
    a, b, c, d, p, q = np.uint64(c0), np.uint64(c1), np.uint64(c2), np.uint64(c3), np.uint64(k0), np.uint64(k1)
    # written out: a loop in here would keep loops over blocks out of vector registers
    a, b, c, d, p, q = _philox_round(a, b, c, d, p, q)
    a, b, c, d, p, q = _philox_round(a, b, c, d, p, q)
    a, b, c, d, p, q = _philox_round(a, b, c, d, p, q)
    a, b, c, d, p, q = _philox_round(a, b, c, d, p, q)
    a, b, c, d, p, q = _philox_round(a, b, c, d, p, q)
    a, b, c, d, p, q = _philox_round(a, b, c, d, p, q)
    a, b, c, d, p, q = _philox_round(a, b, c, d, p, q)
    a, b, c, d, p, q = _philox_round(a, b, c, d, p, q)
    a, b, c, d, p, q = _philox_round(a, b, c, d, p, q)
    a, b, c, d, p, q = _philox_round(a, b, c, d, p, q)
    return a, b, c, d


@inlined
def _philox_round(
    a: np.uint64, b: np.uint64, c: np.uint64, d: np.uint64, p: np.uint64, q: np.uint64
) -> tuple[np.uint64, np.uint64, np.uint64, np.uint64, np.uint64, np.uint64]:
    """Mix the words once with the key's words p and q, and return them with the next key."""
    first, second = a * _MULTIPLIER_0, c * _MULTIPLIER_1
    mixed_0, mixed_1 = (second >> _HALF) ^ b ^ p, (first >> _HALF) ^ d ^ q
    return mixed_0, second & _LOW, mixed_1, first & _LOW, (p + _WEYL_0) & _LOW, (q + _WEYL_1) & _LOW


@inlined
def _philox_block(key: Integer, tick: Integer, index: Integer, domain: np.uint64) -> Words:
    k, t, i = np.uint64(key), np.uint64(tick), np.uint64(index)
    return philox(i & _LOW, i >> _HALF, t & _LOW, (t >> _HALF) ^ domain, k & _LOW, k >> _HALF)


@inner
def _unit_float(high: np.uint64, low: np.uint64) -> float:
    """Return a float in [0, 1) with 53 random bits."""
    return (float(high >> np.uint64(5)) * 67108864.0 + float(low >> np.uint64(6))) / 9007199254740992.0


@borrowing
def uniform(key: Integer, tick: Integer, index: Integer) -> float:
    """Return a uniform number in [0, 1)."""
    a, b, _, _ = _philox_block(key, tick, index, np.uint64(0))
    return _unit_float(a, b)


@borrowing
def normal(key: Integer, tick: Integer, index: Integer) -> float:
    """Return a standard normal number; indices 2 i and 2 i + 1 share one block."""
    i = np.int64(index)
    a, b, c, d = _philox_block(np.uint64(key), np.int64(tick), i >> 1, _NORMALS)
    q = _centred_float(c, d) if i & 1 else _centred_float(a, b)
    return _middle_quantile(q) if abs(q) <= _MIDDLE else _tail_quantile(q)


@borrowing
def fill_normals(key: Integer, tick: Integer, out: NDArray[np.float64]) -> None:
    """Fill ``out`` (K,) with ``normal(key, tick, 0 ..

    K - 1)``, several times as fast: two of the loops run in vector registers.
    """
    k, t = np.uint64(key), np.int64(tick)
    for pair in range(len(out) // 2):
        a, b, c, d = _philox_block(k, t, np.int64(pair), _NORMALS)
        out[2 * pair], out[2 * pair + 1] = _centred_float(a, b), _centred_float(c, d)
    if len(out) % 2:
        a, b, c, d = _philox_block(k, t, np.int64(len(out) // 2), _NORMALS)
        out[-1] = _centred_float(a, b)
    for i in range(len(out)):  # four times a rare q lies beyond all common quantiles, so that the next loop finds it
        out[i] = _middle_quantile(out[i]) if abs(out[i]) <= _MIDDLE else 4.0 * out[i]
    for i in range(len(out)):
        if abs(out[i]) > 1.5:
            out[i] = _tail_quantile(0.25 * out[i])


@inner
def _centred_float(high: np.uint64, low: np.uint64) -> float:
    """Return a number in (-1/2, 1/2) with 52 random bits, never an end or the middle."""
    bits = (high << np.uint64(20)) ^ (low >> np.uint64(12))
    return (float(np.int64(bits)) + 0.5) * 2.0**-52 - 0.5


@borrowing
def _middle_quantile(q: float) -> float:
    """Return the standard normal quantile of 1/2 + q for abs(q) <= 0.425: algorithm AS 241 of Wichura,
    Applied Statistics 37, 1988.
    """
    r = 0.180625 - q * q
    above = (
        (2.5090809287301226727e3 * r + 3.3430575583588128105e4) * r + 6.7265770927008700853e4
    ) * r + 4.5921953931549871457e4
    above = (((above * r + 1.3731693765509461125e4) * r + 1.9715909503065514427e3) * r + 1.3314166789178437745e2) * r
    below = (
        (5.2264952788528545610e3 * r + 2.8729085735721942674e4) * r + 3.9307895800092710610e4
    ) * r + 2.1213794301586595867e4
    below = (((below * r + 5.3941960214247511077e3) * r + 6.8718700749205790830e2) * r + 4.2313330701600911252e1) * r
    return q * (above + 3.3871328727963666080e0) / (below + 1.0)


@borrowing
def _tail_quantile(q: float) -> float:
    """Return the standard normal quantile of 1/2 + q for abs(q) > 0.425 (AS 241)."""
    r = math.sqrt(-math.log(0.5 - abs(q)))
    if r <= 5.0:
        r -= 1.6
        above = ((7.74545014278341407640e-4 * r + 2.27238449892691845833e-2) * r + 2.41780725177450611770e-1) * r
        above = (((above + 1.27045825245236838258e0) * r + 3.64784832476320460504e0) * r + 5.76949722146069140550e0) * r
        above = (above + 4.63033784615654529590e0) * r + 1.42343711074968357734e0
        below = ((1.05075007164441684324e-9 * r + 5.47593808499534494600e-4) * r + 1.51986665636164571966e-2) * r
        below = (
            ((below + 1.48103976427480074590e-1) * r + 6.89767334985100004550e-1) * r + 1.67638483018380384940e0
        ) * r
        below = (below + 2.05319162663775882187e0) * r + 1.0
    else:
        r -= 5.0
        above = ((2.01033439929228813265e-7 * r + 2.71155556874348757815e-5) * r + 1.24266094738807843860e-3) * r
        above = (
            ((above + 2.65321895265761230930e-2) * r + 2.96560571828504891230e-1) * r + 1.78482653991729133580e0
        ) * r
        above = (above + 5.46378491116411436990e0) * r + 6.65790464350110377720e0
        below = ((2.04426310338993978564e-15 * r + 1.42151175831644588870e-7) * r + 1.84631831751005468180e-5) * r
        below = (
            ((below + 7.86869131145613259100e-4) * r + 1.48753612908506148525e-2) * r + 1.36929880922735805310e-1
        ) * r
        below = (below + 5.99832206555887937690e-1) * r + 1.0
    return math.copysign(above / below, q)
