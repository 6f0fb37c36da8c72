"""Shortest curves between two poses: straight lines, Dubins' for cars that drive forwards, Reeds and Shepp's for cars
that also reverse.

A curve is ``pieces`` (5, 2): of each piece the turn (1 left, 0 straight, -1 right) and the signed length in m, negative
backwards; pieces that are not needed have length 0. In words a length of a turn is its angle: they are made for a
turning radius of 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inlined, inner

STRAIGHT, DUBINS, REEDS_SHEPP = 0, 1, 2

Pieces = NDArray[np.float64]
Word = tuple[float, float, float]

_ROUNDING = 1e-9
_HALF, _WHOLE = 0.5 * math.pi, 2.0 * math.pi


class Symmetry(NamedTuple):
    """How a word is changed: its lengths by a sign, its turns by a sign, and whether it is taken from its other end."""

    flip: float
    mirror: float
    backwards: bool


@borrowing
def shortest_curve(
    kind: int, radius: float, first: tuple[float, float, float], second: tuple[float, float, float], pieces: Pieces
) -> float:
    """Write the shortest curve of a kind between two poses into ``pieces`` and return its heading at the start.

    A straight line has the heading of its direction, whatever the headings of its ends.
    """
    x1, y1, theta1 = second
    x0, y0, theta0 = first
    dx, dy = x1 - x0, y1 - y0
    pieces[:] = 0.0
    if kind == STRAIGHT:
        pieces[0, 1] = math.hypot(dx, dy)
        return math.atan2(dy, dx)
    c, s = math.cos(theta0), math.sin(theta0)
    x, y, phi = (c * dx + s * dy) / radius, (c * dy - s * dx) / radius, _wrap_angle(theta1 - theta0)
    if kind == DUBINS:
        _write_dubins(x, y, phi, pieces)
    else:
        _reeds_shepp(x, y, phi, pieces)
    for i in range(5):
        pieces[i, 1] *= radius
    return theta0


@borrowing
def pose_along(
    radius: float, pose: tuple[float, float, float], turn: float, length: float
) -> tuple[float, float, float]:
    """Return the pose after ``length`` m of a piece that begins at a pose."""
    x, y, theta = pose
    if turn == 0.0:
        return x + length * math.cos(theta), y + length * math.sin(theta), theta
    end = theta + turn * length / radius
    return (
        x + turn * radius * (math.sin(end) - math.sin(theta)),
        y - turn * radius * (math.cos(end) - math.cos(theta)),
        end,
    )


@inlined
def _wrap_angle(angle: float) -> float:
    """Return an angle in (-pi, pi]."""
    return angle - _WHOLE * math.ceil((angle - math.pi) / _WHOLE)


@inlined
def _wrap_positive(angle: float) -> float:
    """Return an angle in [0, 2 pi); what rounding keeps from 0 or 2 pi is 0."""
    angle -= _WHOLE * math.floor(angle / _WHOLE)
    return 0.0 if angle < _ROUNDING or angle > _WHOLE - _ROUNDING else angle


@inner
def _write_dubins(x: float, y: float, phi: float, pieces: Pieces) -> None:
    """Choose the shortest of Dubins' six words (formulas of Shkel and Lumelsky, Robotics and
    Autonomous Systems 34, 2001).
    """
    d, theta = math.sqrt(x * x + y * y), math.atan2(y, x)
    a, b = -theta, phi - theta
    sa, ca, sb, cb, cab = math.sin(a), math.cos(a), math.sin(b), math.cos(b), math.cos(a - b)
    best = math.inf
    for side in (1.0, -1.0):  # L S L, R S R
        squared = 2.0 + d * d - 2.0 * cab + side * 2.0 * d * (sa - sb)
        at = math.atan2(side * (cb - ca), d + side * (sa - sb))
        t, p, q = _wrap_positive(side * (at - a)), math.sqrt(max(squared, 0.0)), _wrap_positive(side * (b - at))
        if squared > -_ROUNDING and t + p + q < best:
            best = t + p + q
            _write_pieces(pieces, side, t, 0.0, p, side, q)
    for side in (1.0, -1.0):  # L S R, R S L
        squared = -2.0 + d * d + 2.0 * cab + side * 2.0 * d * (sa + sb)
        if squared > -_ROUNDING:
            p = math.sqrt(max(squared, 0.0))
            at = math.atan2(-side * (ca + cb), d + side * (sa + sb)) - math.atan2(-2.0 * side, p)
            t, q = _wrap_positive(side * (at - a)), _wrap_positive(side * (at - b))
            if t + p + q < best:
                best = t + p + q
                _write_pieces(pieces, side, t, 0.0, p, -side, q)
    for side in (1.0, -1.0):  # L R L, R L R
        cosine = (6.0 - d * d + 2.0 * cab - side * 2.0 * d * (sa - sb)) / 8.0
        if abs(cosine) <= 1.0:
            p = _WHOLE - math.acos(cosine)
            t = _wrap_positive(side * (math.atan2(side * (cb - ca), d + side * (sa - sb)) - a) + 0.5 * p)
            q = _wrap_positive(side * (b - a) - t + p)
            if t + p + q < best:
                best = t + p + q
                _write_pieces(pieces, side, t, -side, p, side, q)


@inner
def _write_pieces(
    pieces: Pieces, turn0: float, length0: float, turn1: float, length1: float, turn2: float, length2: float
) -> None:
    pieces[0, 0], pieces[0, 1] = turn0, length0
    pieces[1, 0], pieces[1, 1] = turn1, length1
    pieces[2, 0], pieces[2, 1] = turn2, length2


@inner
def _reeds_shepp(x: float, y: float, phi: float, pieces: Pieces) -> None:
    """Choose the shortest word of Reeds and Shepp (Pacific Journal of Mathematics 145, 1990, section 8).

    Each formula is tried as it is, driven backwards (x and phi negated), mirrored (y and phi negated) and both; those
    that are not symmetric also from the other end.
    """
    best = math.inf
    for flip in (1.0, -1.0):
        for mirror in (1.0, -1.0):
            u, v, angle = flip * x, mirror * y, flip * mirror * phi
            best = _symmetric_words((u, v, angle), flip, mirror, best, pieces)
            best = _turning_words((u, v, angle), Symmetry(flip, mirror, False), best, pieces)
            c, s = math.cos(angle), math.sin(angle)
            best = _turning_words((u * c + v * s, u * s - v * c, angle), Symmetry(flip, mirror, True), best, pieces)


@inner
def _symmetric_words(word: Word, flip: float, mirror: float, best: float, pieces: Pieces) -> float:
    """Try (8.1), (8.2), (8.7), (8.8) and (8.11), and return the least length so far."""
    x, y, phi = word
    s, c = math.sin(phi), math.cos(phi)
    xi, eta = x - s, y - 1.0 + c
    u, t = math.sqrt(xi * xi + eta * eta), math.atan2(eta, xi)
    v = _wrap_angle(phi - t)
    if t >= -_ROUNDING and v >= -_ROUNDING:  # L+ S+ L+
        best = _keep_shorter(Symmetry(flip, mirror, False), best, pieces, ((1, t), (0, u), (1, v), (0, 0.0), (0, 0.0)))
    xi, eta = x + s, y - 1.0 - c
    squared = xi * xi + eta * eta
    rho = math.sqrt(squared)
    if squared >= 4.0:  # L+ S+ R+
        u = math.sqrt(squared - 4.0)
        t = _wrap_angle(math.atan2(eta, xi) + math.atan2(2.0, u))
        v = _wrap_angle(t - phi)
        if t >= -_ROUNDING and v >= -_ROUNDING:
            best = _keep_shorter(
                Symmetry(flip, mirror, False), best, pieces, ((1, t), (0, u), (-1, v), (0, 0.0), (0, 0.0))
            )
    if rho <= 2.0:  # L+ R+ L- R-
        u = math.acos(0.25 * (2.0 + rho))
        t, v = _outer_turns(u, -u, xi, eta, phi)
        if t >= -_ROUNDING and v <= _ROUNDING:
            best = _keep_shorter(
                Symmetry(flip, mirror, False), best, pieces, ((1, t), (-1, u), (1, -u), (-1, v), (0, 0.0))
            )
    cosine = (20.0 - squared) / 16.0
    if 0.0 <= cosine <= 1.0:  # L+ R- L- R+
        u = -math.acos(cosine)
        t, v = _outer_turns(u, u, xi, eta, phi)
        if t >= -_ROUNDING and v >= -_ROUNDING:
            best = _keep_shorter(
                Symmetry(flip, mirror, False), best, pieces, ((1, t), (-1, u), (1, u), (-1, v), (0, 0.0))
            )
    if rho >= 2.0:  # L+ R- S- L- R+
        u = 4.0 - math.sqrt(squared - 4.0)
        if u <= _ROUNDING:
            t = _wrap_angle(math.atan2((4.0 - u) * xi - 2.0 * eta, -2.0 * xi + (u - 4.0) * eta))
            v = _wrap_angle(t - phi)
            if t >= -_ROUNDING and v >= -_ROUNDING:
                best = _keep_shorter(
                    Symmetry(flip, mirror, False), best, pieces, ((1, t), (-1, -_HALF), (0, u), (1, -_HALF), (-1, v))
                )
    return best


@inner
def _outer_turns(u: float, v: float, xi: float, eta: float, phi: float) -> tuple[float, float]:
    """Return the first and the last turn about two inner ones (tau and omega of the paper)."""
    delta = _wrap_angle(u - v)
    a, b = math.sin(u) - math.sin(delta), math.cos(u) - math.cos(delta) - 1.0
    at = math.atan2(eta * a - xi * b, xi * a + eta * b)
    behind = 2.0 * (math.cos(delta) - math.cos(v) - math.cos(u)) + 3.0 < 0.0
    t = _wrap_angle(at + math.pi) if behind else _wrap_angle(at)
    return t, _wrap_angle(t - u + v - phi)


@inner
def _turning_words(word: Word, symmetry: Symmetry, best: float, pieces: Pieces) -> float:
    """Try (8.3), (8.9) and (8.10), and return the least length so far."""
    x, y, phi = word
    s, c = math.sin(phi), math.cos(phi)
    xi, eta = x - s, y - 1.0 + c
    rho, theta = math.sqrt(xi * xi + eta * eta), math.atan2(eta, xi)
    if rho <= 4.0:  # L+ R- L
        u = -2.0 * math.asin(0.25 * rho)
        t = _wrap_angle(theta + 0.5 * u + math.pi)
        v = _wrap_angle(phi - t + u)
        if t >= -_ROUNDING and u <= _ROUNDING:
            best = _keep_shorter(symmetry, best, pieces, ((1, t), (-1, u), (1, v), (0, 0.0), (0, 0.0)))
    if rho >= 2.0:  # L+ R- S- L-
        r = math.sqrt(rho * rho - 4.0)
        t = _wrap_angle(theta + math.atan2(r, -2.0))
        v = _wrap_angle(phi - _HALF - t)
        if t >= -_ROUNDING and 2.0 - r <= _ROUNDING and v <= _ROUNDING:
            best = _keep_shorter(symmetry, best, pieces, ((1, t), (-1, -_HALF), (0, 2.0 - r), (1, v), (0, 0.0)))
    xi, eta = x + s, y - 1.0 - c
    rho, t = math.sqrt(xi * xi + eta * eta), math.atan2(xi, -eta)
    if rho >= 2.0:  # L+ R- S- R-
        v = _wrap_angle(t + _HALF - phi)
        if t >= -_ROUNDING and v <= _ROUNDING:
            best = _keep_shorter(symmetry, best, pieces, ((1, t), (-1, -_HALF), (0, 2.0 - rho), (-1, v), (0, 0.0)))
    return best


@inner
def _keep_shorter(symmetry: Symmetry, best: float, pieces: Pieces, word: tuple[tuple[int, float], ...]) -> float:
    """Write a word of (turn, length) if it is shorter than ``best``, and return the shorter length."""
    first, second, third, fourth, fifth = word
    total = abs(first[1]) + abs(second[1]) + abs(third[1]) + abs(fourth[1]) + abs(fifth[1])
    if total >= best:
        return best
    word = (first, second, third, fourth, fifth)
    for i in range(5):
        turn, length = word[4 - i] if symmetry.backwards else word[i]
        pieces[i, 0], pieces[i, 1] = symmetry.mirror * turn, symmetry.flip * length
    return total
