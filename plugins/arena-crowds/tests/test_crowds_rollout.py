import numpy as np
import pytest

from arena_core import Crowd, PedestrianModel
from arena_crowds.orca.walkers import Walkers
from arena_crowds.replay.recordings import read_recording
from arena_crowds.slots import no_crowd, with_worlds
from arena_crowds.validation import rollout


class Drifters(PedestrianModel):
    """People who keep their velocities."""

    def reset(self, slots, scenarios, total):
        walkers = Walkers(total)
        walkers.begin_slots(
            dict(zip(slots.tolist(), scenarios, strict=True)), [scenario.world.grid for scenario in scenarios]
        )
        return with_worlds(no_crowd(total), {slot: walkers.crowd.world(slot) for slot in slots.tolist()})

    def step(self, crowd, robots, ticks, dt):
        self.seen = crowd
        return Crowd(
            crowd.counts,
            crowd.ids,
            crowd.positions + dt * crowd.velocities,
            crowd.velocities,
            crowd.radii,
            crowd.states,
        )


@pytest.fixture
def two_walks(tmp_path):
    """Return a recording: person 1 straight along x at 1 m/s for 12 s, person 2 in a bend beside for 6 s."""
    rows = [(10 * k, 1, 0.4 * k, 0.0) for k in range(31)] + [
        (10 * k, 2, 0.4 * k, 3.0 + 0.02 * k * k) for k in range(16)
    ]
    path = tmp_path / "walks.txt"
    path.write_text("".join(" ".join(map(str, row)) + "\n" for row in rows))
    return read_recording(path, "frames", 25.0, "m")


def test_moments_ask_for_those_who_were_seen_long_enough_and_stay(two_walks):
    found = rollout.find_moments(two_walks)
    assert [round(moment.time, 3) for moment in found] == [round(0.4 * k, 3) for k in range(7, 19)]
    assert [moment.asked.tolist() for moment in found[:2]] == [[True, False], [True, False]]
    assert found[0].walks.tolist() == [0, 1]
    assert found[0].goals.tolist() == [[12.0, 0.0], [6.0, 7.5]]
    assert found[0].speeds[0] == pytest.approx(1.0)
    assert found[0].velocities[1] == pytest.approx((1.0, (0.02 * 49 - 0.02 * 36) / 0.4))


def test_a_straight_walk_is_predicted_without_error(two_walks):
    found = rollout.find_moments(two_walks)
    truth = np.concatenate([rollout._recorded_positions(two_walks, moment) for moment in found])
    for guess in (
        rollout._straight_predictions(found, to_goal=False),
        rollout._straight_predictions(found, to_goal=True),
        rollout.predict_jointly(Drifters(), two_walks, found),
        rollout.predict_individually(Drifters(), two_walks, found),
    ):
        assert guess.shape == truth.shape == (12, 12, 2)
        assert np.abs(guess - truth).max() < 1e-6


def test_others_are_led_as_recorded_while_they_are_there(two_walks):
    drifters = Drifters()
    rollout.predict_individually(drifters, two_walks, rollout.find_moments(two_walks)[:1])
    there, _ = two_walks.at(np.array([1]), np.array([6.0]))
    last = drifters.seen.positions[0, 1]
    assert last[0] > there[0, 0] + 1.0  # recorded until 6 s, walks on until 7.6 s
    rollout.predict_jointly(drifters, two_walks, rollout.find_moments(two_walks)[:1])
    assert np.abs(drifters.seen.positions[0, 1] - last).max() > 0.3


def test_constant_velocity_errs_on_zara_as_elsewhere(zara):
    """Widely reported for this recording: about 0.4 and 0.9 m."""
    recording = read_recording(zara, "obsmat")
    found = rollout.find_moments(recording)
    truth = np.concatenate([rollout._recorded_positions(recording, moment) for moment in found])
    errors = np.linalg.norm(rollout._straight_predictions(found, to_goal=False) - truth, axis=-1)
    assert len(errors) > 2000
    assert 0.35 < errors.mean() < 0.5
    assert 0.8 < errors[:, -1].mean() < 1.1
