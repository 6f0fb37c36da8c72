import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arena_crowds.validation import lanes
from arena_crowds.validation.command import build_model
from arena_crowds.validation.lanes import CORRIDOR, MEASURED, lane_order, measure_lanes


def test_lanes_without_strangers_are_in_order_one():
    forward = np.array([True] * 6 + [False] * 4)
    order, expected = lane_order(forward, np.array([0, 0, 0, 1, 1, 1, 2, 2, 3, 3]))
    assert order == pytest.approx(1.0)
    assert 0.0 < expected < 1.0


@pytest.mark.slow
@given(st.integers(0, 2**32 - 1), st.integers(6, 40), st.integers(3, 37))
def test_directions_dealt_out_at_random_are_as_ordered_as_expected(seed, people, ahead):
    random = np.random.default_rng(seed)
    forward, bands = np.arange(people) < min(ahead, people - 3), random.integers(0, 8, people)
    orders = [lane_order(random.permutation(forward), bands)[0] for _ in range(400)]
    assert np.mean(orders) == pytest.approx(lane_order(forward, bands)[1], abs=6.0 * np.std(orders) / 20.0 + 1e-9)


def test_people_are_measured_in_the_middle_of_the_corridor():
    """Five walk to the right in the upper half, five to the left in the lower half."""
    times = np.arange(0.0, 4.0, 1.0 / lanes.RATE)
    starts = (MEASURED.left + MEASURED.right) / 2 + np.linspace(-2.0, 2.0, 5)
    right = np.stack((starts + 1.2 * times[:, None], np.full((len(times), 5), CORRIDOR.top - 1.0)), axis=-1)
    left = np.stack((starts - 0.8 * times[:, None], np.full((len(times), 5), CORRIDOR.bottom + 1.0)), axis=-1)
    outside = np.full((len(times), 1, 2), 1.0)
    density, speed, order, expected = measure_lanes(np.concatenate((right, left, outside), axis=1)).T
    assert density == pytest.approx(10 / MEASURED.size)
    assert speed == pytest.approx(1.0)
    assert order == pytest.approx(1.0)
    assert (expected < 0.2).all()


def test_with_too_few_people_one_way_there_is_no_order():
    positions = np.full((3, 8, 2), ((MEASURED.left + MEASURED.right) / 2, CORRIDOR.top - 1.0)) + np.arange(3)[
        :, None, None
    ] * (1.0, 0.0)
    assert np.isnan(measure_lanes(positions)[:, 1:]).all()


@pytest.mark.slow
@pytest.mark.parametrize("preset", ["social_force", "orca"])
def test_people_form_lanes(monkeypatch, preset):
    monkeypatch.setattr(lanes, "NUMBERS", (80,))
    monkeypatch.setattr(lanes, "SEEDS", 1)
    (row,) = lanes.run({preset: build_model(preset, [])}, None).rows
    assert row["lanes"] > 0.15
    assert row["speed_m_per_s"] > 0.6
