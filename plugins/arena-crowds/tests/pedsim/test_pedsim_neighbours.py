import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from arena_kernels.neighbours import CELLS_FROM, all_pairs, near_pairs, pairs_by_cells

NO_ROOM = np.empty((0, 2), np.int32)


@given(st.integers(0, 2**32), st.integers(2, 150), st.floats(0.5, 400.0), st.floats(0.2, 8.0))
def test_cells_list_the_same_pairs_in_the_same_order(seed, number, side, reach):
    positions = np.random.default_rng(seed).uniform(-side, side, (number, 2))
    expected, found = all_pairs(positions, reach, NO_ROOM)
    pairs, found_by_cells = pairs_by_cells(positions, reach, NO_ROOM)
    assert found == found_by_cells
    assert (pairs[:found] == expected[:found]).all()


def test_pairs_are_those_within_reach():
    positions = np.random.default_rng(1).uniform(0.0, 10.0, (60, 2))
    pairs, found = near_pairs(positions, 2.0, NO_ROOM)
    apart = np.hypot(*(positions[:, None] - positions).transpose(2, 0, 1))
    assert set(map(tuple, pairs[:found].tolist())) == {(i, j) for i, j in np.argwhere(apart < 2.0).tolist() if i < j}


def test_a_crowd_walks_alike_with_either_list(stage, make_model):
    """People too far away to matter tip the choice from all pairs to cells; no one may notice."""
    hall = stage.hall(80, 12)
    near = [
        stage.person(k, (2 + 0.8 * (k % 10), 2 + 0.9 * (k // 10)), (10 - 0.8 * (k % 10), 9 - k // 10), (2, 2))
        for k in range(CELLS_FROM - 8)
    ]
    far = [stage.person(100 + k, (70 + k % 9, 2 + k // 9)) for k in range(20)]
    *_, few = stage.walk(make_model(), stage.scenario(hall, near), 10.0)
    *_, many = stage.walk(make_model(), stage.scenario(hall, near + far), 10.0)
    assert few.positions[0].tobytes() == many.positions[0, : len(near)].tobytes()
