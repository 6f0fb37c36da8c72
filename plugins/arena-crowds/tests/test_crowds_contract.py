"""The contract of pedestrian models notices what breaks it, whoever puts the people there."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import ABSENT, Gait
from arena_core.hosting import ContractViolation
from arena_core.testing import check, robot
from arena_crowds.orca.crowd import OrcaCrowd
from arena_crowds.orca.walkers import STANDING
from arena_crowds.replay.crowd import ReplayedCrowd

GAIT = Gait(0.05, 0.17, 0.11, 1.34, 0.0065, 0.75, 0.3)


@pytest.fixture
def replayed():
    path = "pkg://arena_crowds/recordings/crossing.txt"
    return lambda kind=ReplayedCrowd: kind(
        path, "frames", None, None, "cubic", [0.0, 0.0], 0.0, 1.0, 3.0, 1.0, 0.25, "discs", GAIT
    )


class SwapsNumbers(ReplayedCrowd):
    def step(self, crowd, robots, ticks, dt):
        after = super().step(crowd, robots, ticks, dt)
        return replace(after, ids=after.ids + np.int32(1))


class StandsNowhere(ReplayedCrowd):
    def step(self, crowd, robots, ticks, dt):
        after = super().step(crowd, robots, ticks, dt)
        return replace(after, states=np.where(after.states == ABSENT, STANDING, after.states).astype(np.int8))


class LooksAtTheTask(ReplayedCrowd):
    def _start_of(self, scenario):
        return 3.0 + len(scenario.pedestrians)


class Hurries(OrcaCrowd):
    def step(self, crowd, robots, ticks, dt):
        return super().step(crowd, robots, ticks, 3.0 * dt)


def test_recorded_people_hold_the_contract(replayed):
    assert "people who are not the scenario's walk alike without those" in check("pedestrians", replayed(), robot())


@pytest.mark.parametrize(
    ("kind", "says"),
    [
        (SwapsNumbers, "people keep their numbers"),
        (StandsNowhere, "who is absent is at NaN"),
        (LooksAtTheTask, "people who are not the scenario's walk alike"),
    ],
)
def test_what_breaks_the_contract_is_named(replayed, kind, says):
    with pytest.raises(ContractViolation, match=says):
        check("pedestrians", replayed(kind), robot())


def test_people_who_hurry_are_noticed(orca):
    hurried = Hurries.__new__(Hurries)
    hurried.__dict__ = orca.__dict__
    with pytest.raises(ContractViolation, match="no one faster than they may"):
        check("pedestrians", hurried, robot())
