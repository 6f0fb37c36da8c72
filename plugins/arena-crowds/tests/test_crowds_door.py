import numpy as np
import pytest

from arena_crowds.validation import door
from arena_crowds.validation.command import build_model
from arena_crowds.validation.door import PEOPLE, SIDE, WALL, door_flow, evacuation_scenario, passing_times
from arena_crowds.validation.walks import simulate_walks


def test_the_flow_is_that_of_a_steady_stream():
    assert door_flow(3.0 + 0.4 * np.arange(PEOPLE)) == pytest.approx(2.5)


def test_a_door_that_clogs_has_no_flow():
    times = np.where(np.arange(PEOPLE) < 20, np.arange(PEOPLE), np.inf)
    assert door_flow(times) == 0.0


def test_passing_times_are_those_of_the_wall():
    times = np.arange(0.0, 10.0, 0.1)
    x = np.stack([SIDE + WALL - 2.0 + times, SIDE + WALL - 1.0 + times, np.full(100, 1.0)], axis=1)
    positions = np.stack((x, np.ones_like(x)), axis=-1)[:, None]
    assert passing_times(positions)[0] == pytest.approx([1.0, 2.0, np.inf], abs=0.11)


def test_nobody_starts_in_anybody():
    people = np.array([person.position_xy for person in evacuation_scenario(1.0, 1.34, 3).pedestrians])
    apart = np.hypot(*(people[:, None] - people[None]).transpose(2, 0, 1))
    assert apart[np.triu_indices(PEOPLE, 1)].min() > 0.4


@pytest.mark.slow
def test_as_many_get_out_as_in_experiments():
    positions = simulate_walks(
        build_model("social_force", []), [evacuation_scenario(1.2, 1.34, seed) for seed in range(2)], 60.0, door.RATE
    )
    flows = [door_flow(own) / 1.2 for own in passing_times(positions)]
    assert 1.3 < np.mean(flows) < 2.1
