"""What moves by a timetable is where it says, along Gazebo's spline, and begins again."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from arena_core import ABSENT, PedestrianSpec
from arena_core.testing import component

KEYS = np.array(((5.0, 5.0), (7.0, 5.0), (8.0, 8.0)))
STAMPS = np.array((0.0, 2.0, 3.0))


def crowd(*overrides):
    return component("pedestrians", "timetable", [f"pedestrians.{override}" for override in overrides])


def mover(id=0, keys=KEYS, stamps=STAMPS):
    return PedestrianSpec(id, keys[0], keys, 3.0, 0.5, stamps=stamps)


def walked(model, scenarios, stage, seconds, dt=0.05):
    """Return positions (T, N, P, 2) and states, step by step from the begin on."""
    worlds = len(scenarios)
    now = model.reset(np.arange(worlds), scenarios, worlds)
    rows = [now]
    for tick in range(round(seconds / dt)):
        now = model.step(now, stage.robots(), np.full(worlds, tick), dt)
        rows.append(now)
    return np.array([row.positions for row in rows]), np.array([row.states for row in rows])


def test_key_places_are_reached_at_their_stamps(stage):
    positions, _ = walked(crowd("start_time=0.0"), [stage.scenario(stage.hall(20, 20), [mover()])], stage, 2.95)
    assert positions[0, 0, 0] == pytest.approx(KEYS[0])
    assert positions[40, 0, 0] == pytest.approx(KEYS[1])
    assert positions[59, 0, 0] == pytest.approx(KEYS[2], abs=0.2)


def test_between_key_places_it_follows_gazebos_spline(stage):
    positions, _ = walked(crowd("start_time=0.0"), [stage.scenario(stage.hall(20, 20), [mover()])], stage, 2.5)
    # tangents: half the way to the neighbour at an end, (1, 0), half that from neighbour to neighbour between, (1.5,
    # 1.5)
    assert positions[20, 0, 0] == pytest.approx((6.0 + (1.0 - 1.5) / 8.0, 5.0 - 1.5 / 8.0))
    assert positions[50, 0, 0] == pytest.approx((7.5 + (1.5 - 0.5) / 8.0, 6.5))


def test_it_is_absent_for_a_step_before_it_begins_anew(stage):
    positions, states = walked(crowd("start_time=0.0"), [stage.scenario(stage.hall(20, 20), [mover()])], stage, 6.5)
    gone = np.flatnonzero(states[:, 0, 0] == ABSENT)
    assert len(gone) == 2
    assert np.isnan(positions[gone, 0, 0]).all()
    assert positions[gone + 1, 0, 0] == pytest.approx(positions[[1, 1], 0, 0], abs=0.06)


def test_round_that_ends_where_it_began_has_no_gap(stage):
    keys = np.array(((5.0, 5.0), (7.0, 5.0), (7.0, 7.0), (5.0, 5.0)))
    walk = mover(keys=keys, stamps=np.array((0.0, 1.0, 2.0, 3.5)))
    positions, states = walked(crowd("start_time=0.0"), [stage.scenario(stage.hall(20, 20), [walk])], stage, 8.0)
    assert (states != ABSENT).all()
    assert np.hypot(*np.diff(positions[:, 0, 0], axis=0).T).max() < 0.2


def test_begin_is_drawn_for_each_scenario_and_the_same_again(stage):
    one = stage.scenario(stage.hall(20, 20), [mover()])
    other = dataclasses.replace(one, name="other")
    starts = [crowd().reset(np.zeros(1, np.int64), [each], 1).positions[0, 0].tolist() for each in (one, one, other)]
    assert starts[0] == starts[1] != starts[2]


def test_world_among_others_is_what_it_is_alone(stage):
    full = stage.scenario(stage.hall(20, 20), [mover(), mover(1, KEYS + 4.0, 1.3 * STAMPS)])
    few = dataclasses.replace(stage.scenario(stage.hall(20, 20), [mover()]), name="few")
    alone, _ = walked(crowd(), [full], stage, 4.0)
    model = crowd()
    now = model.reset(np.arange(2), [few, full], 2)
    for tick in range(80):
        now = model.step(now, stage.robots(), np.full(2, tick), 0.05)
    assert np.array_equal(now.positions[1], alone[-1, 0])


def test_who_has_no_timetable_walks_its_waypoints_straight_at_its_speed(stage):
    person = PedestrianSpec(0, np.array((5.0, 5.0)), np.array(((8.0, 5.0), (8.0, 9.0))), 1.0, 0.3)
    positions, states = walked(crowd(), [stage.scenario(stage.hall(20, 20), [person])], stage, 12.5)
    assert positions[20, 0, 0] == pytest.approx((6.0, 5.0))
    assert positions[100, 0, 0] == pytest.approx((8.0, 7.0))
    assert positions[250, 0, 0] == pytest.approx((5.5, 5.0), abs=0.01)
    assert (states != ABSENT).all()


def test_body_comes_out_of_a_wall_and_goes_into_the_other(stage):
    keys = np.array(((0.0, 5.0), (10.0, 5.0), (20.0, 5.0)))
    walk = mover(keys=keys, stamps=np.array((0.0, 10.0, 20.0)))
    positions, states = walked(crowd("start_time=0.0"), [stage.scenario(stage.hall(20, 20), [walk])], stage, 19.9)
    there = np.flatnonzero(states[:, 0, 0] != ABSENT)
    assert states[0, 0, 0] == ABSENT
    assert (np.diff(there) == 1).all()
    # half a metre of its own, a cell of the wall
    assert positions[there[[0, -1]], 0, 0, 0] == pytest.approx((0.55, 19.45), abs=0.08)
