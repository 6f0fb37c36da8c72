"""People who come and go: who is not in the world is neither seen nor touched nor measured."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from arena_core import ABSENT, Crowd, Footprint, PedestrianModel, Pose
from arena_core.testing import component, robot, scan, scenario
from arena_core.testing.samples import person

NOWHERE = (np.nan, np.nan)
BOX = Footprint.polygon([[0.25, -0.2], [0.25, 0.2], [-0.25, 0.2], [-0.25, -0.2]])
BODIES = [robot(), replace(robot(), footprint=BOX)]
PERIOD = 0.05  # s between two crowd steps


class Script(PedestrianModel):
    """People in state 2 who are, after k crowd steps, where row k (P, 2) says, and stay where the last row says."""

    def __init__(self, *rows) -> None:
        self.rows = np.array(rows, float)
        self.given: list[Crowd] = []

    def reset(self, slots, scenarios, total):
        return self._crowd(np.zeros(total, int))

    def step(self, crowd, robots, ticks, dt):
        self.given.append(crowd)
        return self._crowd(np.rint(ticks * 0.01 / dt).astype(int) + 1)

    def _crowd(self, row):
        positions = self.rows[np.minimum(row, len(self.rows) - 1)]
        worlds, people = positions.shape[:2]
        ids = np.tile(np.arange(people, dtype=np.int32), (worlds, 1))
        radii, states = np.full((worlds, people), 0.3), np.full((worlds, people), 2, np.int8)
        return Crowd(np.full(worlds, people, np.int32), ids, positions, 0.0 * positions, radii, states)


@pytest.fixture
def among() -> Callable[..., tuple]:
    """Return a function that puts a robot at the origin among scripted people, and that script."""

    def make(body, *rows):
        script = Script(*rows)
        timing = ["simulator.inner_step=0.01", f"simulator.crowd_period={PERIOD}"]
        simulator = component("simulator", "sim2d", timing, robot=body, pedestrians=script)
        people = [person(k, 0.0, 0.0) for k in range(script.rows.shape[1])]
        return simulator, simulator.reset([replace(scenario(start=Pose(0.0, 0.0)), pedestrians=tuple(people))]), script

    return make


def drive(simulator, periods, speed=0.0):
    return [simulator.advance(np.array(((speed, 0.0, 0.0),)), 5) for _ in range(periods)]


@pytest.mark.parametrize("body", BODIES)
def test_a_world_of_absent_people_is_an_empty_one(among, body):
    simulator, first, _ = among(body, [NOWHERE, NOWHERE])
    empty, alone, _ = among(body, np.empty((0, 2)))
    for snapshot, other in zip([first, *drive(simulator, 150, 1.0)], [alone, *drive(empty, 150, 1.0)], strict=True):
        assert snapshot.ranges.tobytes() == other.ranges.tobytes()
        assert snapshot.poses.tobytes() == other.poses.tobytes()
        assert snapshot.contacts == other.contacts
        assert snapshot.clearances_people.tolist() == [np.inf]
        assert snapshot.clearances.tolist() == other.clearances.tolist()
    assert snapshot.contacts == ((),)
    assert snapshot.in_contact[0]  # of the wall that it has reached


def test_the_absent_are_nowhere_in_state_absent_whatever_the_model_says(among):
    simulator, first, script = among(robot(), [NOWHERE, (1.0, 2.0)])
    for snapshot in (first, *drive(simulator, 3)):
        assert np.isnan(snapshot.crowd.positions[0, 0]).all()
        assert np.isnan(snapshot.crowd.velocities[0, 0]).all()
        assert snapshot.crowd.states[0].tolist() == [ABSENT, 2]
        assert snapshot.crowd.ids[0].tolist() == [0, 1]
    assert script.given[-1].states[0].tolist() == [ABSENT, 2]


def test_who_comes_is_there_at_once_and_who_leaves_is_gone_at_once(among):
    simulator, first, _ = among(robot(), [NOWHERE], [(2.0, 0.0)], [(2.0, 0.05)], [NOWHERE])
    come, walked, gone = drive(simulator, 3)
    assert first.ranges[0, 90] > 4.0
    assert come.crowd.positions[0, 0].tolist() == [2.0, 0.0]
    assert come.clearances_people[0] == pytest.approx(1.5)
    assert walked.crowd.positions[0, 0] == pytest.approx((2.0, 0.05))
    assert np.isnan(gone.crowd.positions).all()
    assert gone.clearances_people[0] == np.inf


def test_a_scan_does_not_see_who_has_left(among):
    simulator, first, _ = among(robot(), [(2.0, 0.0)], [NOWHERE])
    assert first.ranges[0, 90] == pytest.approx(1.7, abs=1e-5)
    after = drive(simulator, 4)[-1]
    assert after.ranges[0] == pytest.approx(scan(Pose(0.0, 0.0), robot()).ranges, abs=1e-4)


@pytest.mark.parametrize("body", BODIES)
def test_a_contact_ends_when_the_person_leaves(among, body):
    simulator, _, _ = among(body, *[[(0.7, 0.0)]] * 40, [NOWHERE])
    *_, pressed = drive(simulator, 38, 0.5)
    assert pressed.in_contact[0]
    assert pressed.poses[0, 0] < 0.21
    *_, free = drive(simulator, 60, 0.5)
    assert not free.in_contact[0]
    assert free.poses[0, 0] > 1.0


@pytest.mark.parametrize("body", BODIES)
def test_nobody_appears_inside_the_robot(among, body):
    simulator, _, _ = among(body, [NOWHERE], [(0.1, 0.1)])
    waiting = drive(simulator, 10)
    assert all(np.isnan(snapshot.crowd.positions).all() for snapshot in waiting)
    assert not any(snapshot.contacts[0] for snapshot in waiting)
    assert waiting[-1].crowd.states[0, 0] == ABSENT
    assert waiting[-1].ranges[0].min() > 4.0
    leaving = drive(simulator, 30, 1.0)
    there = [not np.isnan(snapshot.crowd.positions).any() for snapshot in leaving]
    assert there[-1]
    assert there == sorted(there)
    assert min(snapshot.clearances_people[0] for snapshot in leaving) >= 0.0
    assert not any(snapshot.contacts[0] for snapshot in leaving)
