"""Tracked people, rolled on by the forces of the crowd."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import ConfigurationError, OccupancyGrid, PedestrianSpec, Pose, RobotBatch, World
from arena_core.testing import check, component, robot, scenario, tracked, view


@pytest.fixture(scope="module")
def predictor():
    return component("predictor", "social_force")


def places(predictor, tracks, grid=None, time=2.0, steps=1):
    """Return where tracks are in ``time`` s once the predictor has watched them stand so for some steps."""
    predictor.reset(grid)
    told = [predictor.predict(view(tracks=tracks, stamp=0.1 * k)) for k in range(steps)][-1]
    return told.at((time,))[:, 0]


def corridor(*blocked):
    """Return a map, 8 m wide, with a wall from y = 1 m on and boxes of (x, x, y, y)."""
    data = np.zeros((160, 160), np.int8)
    data[100:, :] = 100
    for x_min, x_max, y_min, y_max in blocked:
        rows, columns = ([round((v + 4.0) / 0.05) for v in pair] for pair in ((y_min, y_max), (x_min, x_max)))
        data[slice(*rows), slice(*columns)] = 100
    return OccupancyGrid(data, 0.05, Pose(-4.0, -4.0))


def test_it_keeps_the_contract(predictor):
    assert check("predictor", component("predictor", "social_force"), robot())


def test_who_is_alone_walks_straight_on(predictor):
    assert places(predictor, tracked((0.0, 0.0, 0.6, 0.0))) == pytest.approx(np.array(((1.2, 0.0),)), abs=0.02)


def test_two_who_meet_head_on_do_not_walk_through_each_other(predictor):
    tracks = tracked((0.0, 0.0, 0.8, 0.0), (2.0, 0.05, -0.8, 0.0))
    predictor.reset(None)
    told = predictor.predict(view(tracks=tracks)).at(np.arange(0.0, 2.3, 0.1))
    straight = tracks.positions[:, None] + tracks.velocities[:, None] * np.arange(0.0, 2.3, 0.1)[:, None]
    gaps, through = (np.hypot(*(way[0] - way[1]).T).min() for way in (told, straight))
    assert through < 0.1
    assert gaps > 0.4


def test_who_walks_at_a_wall_turns_along_it(predictor):
    ((x, y),) = places(predictor, tracked((0.0, 0.0, 0.3, 0.5)), corridor())
    assert y < 0.75
    assert x > 0.65


def test_without_a_map_there_are_no_walls(predictor):
    ((_, y),) = places(predictor, tracked((0.0, 0.0, 0.3, 0.5)))
    assert y == pytest.approx(1.0, abs=0.02)


def test_a_person_is_told_apart_from_who_had_another_number(predictor):
    one, other = (places(predictor, tracked((0.0, 0.0, 0.5, 0.0)), steps=k) for k in (1, 30))
    assert one == pytest.approx(other, abs=0.02)


def test_a_track_without_numbers_costs_the_others_nothing(predictor):
    lost = tracked((np.nan, 0.0, 0.5, 0.0), (0.0, 0.0, 0.6, 0.0))
    assert places(predictor, lost)[1] == pytest.approx((1.2, 0.0), abs=0.02)


def test_it_foresees_a_crowd_better_than_straight_lines():
    """Two streams that meet, in the crowd's own world: the error two seconds ahead, over twenty seconds."""
    ends = [((x, y), (x + 4.2, y)) for x in (-3.0, -1.8, -0.6) for y in (-0.6, 0.6)]
    ends = [pair if k % 2 else (pair[1], pair[0]) for k, pair in enumerate(ends)]
    specs = [PedestrianSpec(k + 1, np.array(a), np.array((b, a)), 0.8, 0.3) for k, (a, b) in enumerate(ends)]
    grid = corridor((-4.0, 4.0, -3.9, -1.0))
    problem = replace(scenario(start=Pose(-3.5, -3.9), people=specs), world=World("hall", grid))
    ours, straight = errors(component("pedestrians", "social_force"), component("predictor", "social_force"), problem)
    assert ours < 0.9 * straight


def errors(crowd, predictor, problem):
    """Return the mean error 2 s ahead of the predictor and of straight lines."""
    now = crowd.reset(np.zeros(1, np.int64), [problem], 1)
    nobody = RobotBatch(np.full((1, 3), RobotBatch.FAR), np.zeros((1, 2)), 0.2)
    states, told = [], []
    predictor.reset(problem.world.grid)
    for k in range(200):
        for _ in range(2):
            now = crowd.step(now, nobody, np.array((2 * k,)), 0.05)
        states.append(np.column_stack((now.positions[0], now.velocities[0])))
        told.append(predictor.predict(view(tracks=tracked(*states[-1].tolist()), stamp=0.1 * k)).at((2.0,))[:, 0])
    straight = [state[:, :2] + 2.0 * state[:, 2:] for state in states]
    return [
        np.mean([np.hypot(*(one[k] - states[k + 20][:, :2]).T) for k in range(10, 180)]) for one in (told, straight)
    ]


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("predictor.reckoned.step=0.5", "predictor.reckoned.step is 0.5"),
        ("pedestrians@predictor.crowd=none", "allowed: social_force"),
    ],
)
def test_what_cannot_be_is_refused(word, said):
    with pytest.raises(ConfigurationError, match=said):
        component("predictor", "social_force", [word])
