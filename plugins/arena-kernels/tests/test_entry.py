"""Entered kernels do what kernels do, whoever made the arrays."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.entry import Entered


class Pair(NamedTuple):
    values: NDArray[np.float64]
    factor: float


@borrowing
def scale(pair, out):
    for k in range(len(pair.values)):
        out[k] = pair.factor * pair.values[k]
    return len(pair.values)


def test_an_entered_kernel_does_what_the_kernel_does():
    enter = Entered(scale)
    pair, ours, theirs = Pair(np.arange(3.0), 2.5), np.zeros(3), np.zeros(3)
    for _ in range(2):
        assert enter(pair, ours) == scale(pair, theirs) == 3
    np.testing.assert_array_equal(ours, theirs)


def test_an_entered_kernel_reads_what_cannot_be_written_to():
    enter = Entered(scale)
    enter(Pair(np.empty(0), 1.0), np.empty(0))
    kept, out = np.arange(3.0), np.zeros(3)
    kept.setflags(write=False)
    enter(Pair(kept, 2.0), out)
    assert out.tolist() == [0.0, 2.0, 4.0]
