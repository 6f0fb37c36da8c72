import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_mppi.sequence import ControlSequence

RAMP = np.column_stack((np.arange(1, 21) * 0.05, np.zeros(20), np.arange(1, 21) * -0.1)).astype(np.float32)
REST = np.zeros(3, np.float32)


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.floats(0.01, 0.5), st.floats(0.01, 0.4))
def test_a_ramp_is_read_off_at_any_control_period(period, passed):
    sequence = ControlSequence(20, 0.05, 0.25)
    command = sequence.store_sequence(RAMP, REST, 3.0, period)
    assert command[0] == pytest.approx(period, abs=1e-5)
    ahead = sequence.shifted_sequence(REST, 3.0 + passed)
    expected = np.minimum(0.05 * np.arange(1, 21) + passed, 1.0)
    np.testing.assert_allclose(ahead[:, 0], expected, atol=1e-5)
    np.testing.assert_allclose(ahead[:, 2], -2.0 * expected, atol=1e-5)


def test_the_past_goes_on_from_step_to_step():
    sequence = ControlSequence(20, 0.05, 0.25)
    sequence.store_sequence(RAMP, REST, 0.0, 0.1)
    now = np.array((0.1, 0.0, -0.2), np.float32)
    assert sequence.past_velocities(now, 0.1)[:, 0] == pytest.approx([0.0, 0.0, 0.05, 0.1])
    sequence.store_sequence(RAMP + now, now, 0.1, 0.1)
    assert sequence.past_velocities(now, 0.2)[:, 0] == pytest.approx([0.05, 0.1, 0.15, 0.1])


def test_a_measured_velocity_leads_the_planned_one_towards_it():
    sequence, measured = ControlSequence(20, 0.05, 0.25), np.array((0.5, 0.0, -0.2), np.float32)
    assert (sequence.velocity_at(measured, 0.0) == measured).all()
    sequence.store_sequence(RAMP, REST, 0.0, 0.1)
    assert sequence.velocity_at(measured, 0.1) == pytest.approx([0.1 + 0.25 * 0.4, 0.0, -0.2])


def test_without_a_plan_the_present_velocity_goes_on():
    sequence = ControlSequence(20, 0.05, 0.25)
    now = np.array((0.3, 0.0, 0.1), np.float32)
    assert (sequence.shifted_sequence(now, 5.0) == now).all()
    assert (sequence.past_velocities(now, 5.0) == now).all()
    sequence.store_sequence(RAMP, REST, 5.0, 0.1)
    sequence.clear()
    assert (sequence.shifted_sequence(now, 5.1) == now).all()
