"""Regions are those that scipy finds, numbered in the order of their first cells."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from scipy import ndimage

from arena_kernels.connected_components import connected_components


@given(arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, max_side=12), elements=st.booleans()))
def test_regions_are_those_of_scipy(free):
    labels, expected = connected_components(free), ndimage.label(free)[0]
    assert ((labels == 0) == (expected == 0)).all()
    assert len({*zip(labels.flat, expected.flat, strict=True)}) == len({*labels.flat}) == len({*expected.flat})
    firsts = [int(np.flatnonzero(labels.flat == label)[0]) for label in range(1, labels.max(initial=0) + 1)]
    assert firsts == sorted(firsts)


def test_a_grid_without_free_cells_has_no_regions():
    assert not connected_components(np.zeros((3, 4), bool)).any()
