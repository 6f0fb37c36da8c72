"""Entered kernels do what kernels do, whoever made the arrays, and say so where they are checked that types stay."""

from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

import arena_kernels.compiled
from arena_kernels.compiled import TypedDispatch, borrowing


class Pair(NamedTuple):
    values: NDArray[np.float64]
    factor: float


@borrowing
def scale(pair, out):
    for k in range(len(pair.values)):
        out[k] = pair.factor * pair.values[k]
    return len(pair.values)


def test_an_entered_kernel_does_what_the_kernel_does():
    enter = TypedDispatch(scale)
    pair, ours, theirs = Pair(np.arange(3.0), 2.5), np.zeros(3), np.zeros(3)
    for _ in range(2):
        assert enter(pair, ours) == scale(pair, theirs) == 3
    np.testing.assert_array_equal(ours, theirs)


def test_an_entered_kernel_reads_what_cannot_be_written_to():
    enter = TypedDispatch(scale)
    enter(Pair(np.empty(0), 1.0), np.empty(0))
    kept, out = np.arange(3.0), np.zeros(3)
    kept.setflags(write=False)
    enter(Pair(kept, 2.0), out)
    assert out.tolist() == [0.0, 2.0, 4.0]


@pytest.mark.parametrize(
    ("pair", "out", "said"),
    [
        (
            Pair(np.arange(3.0), 1),
            np.zeros(3),
            r"scale: argument 0 is of type \('Pair', 'array\(float64, 1d, C\)', 'int64'\)",
        ),
        (
            Pair(np.arange(3.0), 1.0),
            np.zeros(3, np.float32),
            r"scale: argument 1 is of type array\(float32, 1d, C\), at the first",
        ),
        (Pair(np.arange(6.0)[::2], 1.0), np.zeros(3), r"array\(float64, 1d, A\)"),
        ((np.arange(3.0), 1.0), np.zeros(3), r"scale: argument 0 is of type \('tuple', "),
    ],
)
def test_a_checked_kernel_takes_no_other_types_than_those_of_its_first_call(pair, out, said, monkeypatch):
    monkeypatch.setattr(arena_kernels.compiled, "MODE", "checked")
    enter, kept = TypedDispatch(scale), np.arange(3.0)
    enter(Pair(kept, 2.0), np.zeros(3))
    kept.setflags(write=False)
    assert enter(Pair(kept, 2.0), np.zeros(3)) == 3  # whether it can be written to does not matter
    with pytest.raises(TypeError, match=said):
        enter(pair, out)
