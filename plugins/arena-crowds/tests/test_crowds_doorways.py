"""People before a door in a wall: they wait until it opens, go another way, or give it up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from arena_core import Branches, PedestrianModel, Scenario
from arena_core.scenes import Door, is_open
from arena_core.testing import component

LEAF = np.array([[4.0, 2.4], [4.1, 2.4], [4.1, 3.6], [4.0, 3.6]])
STEP, RADIUS = 0.05, 0.3  # s, m


@pytest.fixture(params=["social_force", "orca"])
def model(request: pytest.FixtureRequest) -> PedestrianModel:
    return component("pedestrians", request.param)  # type: ignore[no-any-return]


def hall(stage: Any, opens: float, *, top: float = 6.0, people: int = 1) -> Scenario:
    """Return a hall of 8 by 6 m whose wall reaches up to ``top``, with a door that opens once; people go to and fro."""
    grid = stage.hall(8, 6, [(4, 0, 4.1, 2.4), (4, 3.6, 4.1, top)])
    walkers = [stage.person(k, (1.0, 3.05 - 0.8 * k), (6.5, 3.05 - 0.8 * k), (1.0, 3.05)) for k in range(people)]
    return replace(stage.scenario(grid, walkers), doors=(Door(LEAF, np.array([[opens, np.inf]])),))


def walk(stage: Any, model: PedestrianModel, scenarios: Sequence[Scenario], seconds: float) -> NDArray[np.float64]:
    """Return where people (T, N, P, 2) are at each step."""
    worlds = len(scenarios)
    crowd = model.reset(np.arange(worlds), scenarios, worlds)
    places = [crowd.positions.copy()]
    for tick in range(round(seconds / STEP)):
        model.watch_doors(np.array([[is_open(each.doors[0], tick * STEP)] for each in scenarios]))
        crowd = model.step(crowd, stage.robots(worlds=worlds), np.full(worlds, tick), STEP)
        places.append(crowd.positions.copy())
    return np.array(places)


def test_who_has_no_other_way_waits_half_a_metre_before_the_door_and_goes_through_once_it_opens(stage, model):
    x = walk(stage, model, [hall(stage, 12.0)], 20.0)[:, 0, 0, 0]
    before = x[round(6.0 / STEP) : round(12.0 / STEP)]
    assert (
        np.abs(before - (4.0 - RADIUS - 0.5)).max() < 0.15
    )  # longer than the stuck period, and yet it has not turned round
    assert x[: round(12.0 / STEP)].max() < 4.0 - RADIUS
    assert x.max() > 6.0


def test_several_wait_and_all_go_through(stage, model):
    x = walk(stage, model, [hall(stage, 10.0, people=3)], 22.0)[:, 0, :, 0]
    assert x[: round(10.0 / STEP)].max() < 4.0 - RADIUS + 1e-6
    assert (x.max(axis=0) > 5.5).all()


def test_who_has_another_way_goes_round(stage, model):
    places = walk(stage, model, [hall(stage, 60.0, top=4.2)], 9.0)[:, 0, 0]
    assert places[:, 0].max() > 6.0
    assert places[places[:, 0].searchsorted(4.0), 1] > 4.2


def test_who_has_waited_for_long_goes_to_the_next_waypoint(stage, model):
    x = walk(stage, model, [hall(stage, 90.0)], 36.0)[:, 0, 0, 0]
    assert x[round(28.0 / STEP)] > 2.8
    assert x[round(28.0 / STEP) :].min() < 1.6


def test_a_world_of_several_is_that_world_alone(stage, model):
    problems = [hall(stage, 3.0, people=2), hall(stage, 60.0), hall(stage, 5.0, people=2)]
    together = walk(stage, model, problems, 8.0)
    for slot, problem in enumerate(problems):
        alone = walk(stage, model, [problem], 8.0)
        np.testing.assert_array_equal(together[:, slot, : alone.shape[2]], alone[:, 0])


def test_a_fork_goes_on_as_the_original_does_when_the_door_opens(stage, model):
    problems = [hall(stage, 60.0), hall(stage, 4.0, people=2)]
    walk(stage, model, problems, 3.5)
    crowd = model.step(model.reset(np.arange(2), problems, 2), stage.robots(worlds=2), np.zeros(2, np.int64), STEP)
    for tick in range(1, 70):
        crowd = model.step(crowd, stage.robots(worlds=2), np.full(2, tick), STEP)
    forked, branch = model.fork(Branches.of([1, 0])), crowd.take(np.array([1, 0]))
    for tick in range(70, 140):
        model.watch_doors(np.array([[False], [tick >= 80]]))
        forked.watch_doors(np.array([[tick >= 80], [False]]))
        crowd = model.step(crowd, stage.robots(worlds=2), np.full(2, tick), STEP)
        branch = forked.step(branch, stage.robots(worlds=2), np.full(2, tick), STEP)
    np.testing.assert_array_equal(branch.positions, crowd.positions[[1, 0]])
    assert crowd.positions[1, 0, 0] > 4.1
