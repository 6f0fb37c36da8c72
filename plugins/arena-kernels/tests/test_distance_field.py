import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from arena_kernels.distance import distance_field


@given(st.integers(1, 40), st.integers(1, 40), st.floats(0.0, 1.0), st.integers(0, 2**32 - 1))
@settings(derandomize=True, deadline=None)
def test_field_equals_the_transform_of_scipy(rows, columns, density, seed):
    blocked = np.random.default_rng(seed).random((rows, columns)) < density
    blocked[seed % rows, seed % columns] = True
    expected = ndimage.distance_transform_edt(~blocked) * 0.05
    np.testing.assert_allclose(distance_field(blocked, 0.05), expected, rtol=1e-6)


@pytest.mark.parametrize("share", [1, 8, 30, 31, 120])
def test_field_is_exact_however_few_columns_hold_blocked_cells(share):
    random = np.random.default_rng(share)
    blocked = np.zeros((90, 120), np.bool_)
    blocked[random.integers(90, size=share), random.permutation(120)[:share]] = True
    away = np.argwhere(blocked)[:, :, None, None] - np.indices(blocked.shape)
    squares = (away**2).sum(axis=1).min(axis=0)
    np.testing.assert_array_equal(distance_field(blocked, 0.05), (np.sqrt(squares) * 0.05).astype(np.float32))


def test_field_without_blocked_cells_is_infinite():
    field = distance_field(np.zeros((3, 4), np.uint8), 0.05)
    assert field.dtype == np.float32
    assert np.isinf(field).all()


def test_field_takes_views_that_are_not_contiguous():
    blocked = np.zeros((6, 6), np.uint8)
    blocked[0, 0] = 1
    assert distance_field(blocked[::-1, ::-1], 0.5)[0, 0] == pytest.approx(5 * 0.5 * 2**0.5)
