"""Reachable sets: never too small, and closed forms where there are some."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from arena_reference.body import Moving, Walkers
from arena_reference.bounds import NOBODY, Clock
from arena_reference.reach import earliest_step, pack
from arena_reference.values import FINE, NEVER, SPANS, STRIDE, Course, goal_values, spread, static_times, times_to_go

SIZE = 150


def cells_of_a_step() -> set[tuple[int, int]]:
    return {(dx, dy) for dy in range(-5, 6) for dx in range(-SPANS[abs(dy)], SPANS[abs(dy)] + 1)}


def test_a_step_reaches_the_cells_within_root_26() -> None:
    disc = {(dx, dy) for dx in range(-6, 7) for dy in range(-6, 7) if dx * dx + dy * dy <= 26}
    assert cells_of_a_step() == disc


def test_the_stride_is_the_greatest_disc_in_their_hull() -> None:
    hull = ConvexHull(np.array(sorted(cells_of_a_step())))
    inscribed = -hull.equations[:, -1].max()
    assert inscribed - 1e-3 < STRIDE <= inscribed


def test_spreading_takes_the_least_within_a_step() -> None:
    values = np.random.default_rng(0).integers(0, 900, (40, 50)).astype(np.uint16)
    found = np.empty_like(values)
    spread(values, found)
    for row, column in ((0, 0), (20, 25), (39, 49), (3, 47)):
        near = [
            values[row + dy, column + dx]
            for dx, dy in cells_of_a_step()
            if 0 <= row + dy < 40 and 0 <= column + dx < 50
        ]
        assert found[row, column] == min(near) + FINE


def first_step(free, goal, start, instants, people=NOBODY, radii=None, speed=STRIDE):
    radii = np.zeros(people.positions.shape[1]) if radii is None else np.asarray(radii, float)
    return earliest_step(pack(free), pack(goal), start, instants, Moving(people, radii, speed))


def disc(x: float, y: float, radius: float):
    rows, columns = np.mgrid[:SIZE, :SIZE] + 0.5
    return np.hypot(columns - x, rows - y) <= radius


@pytest.mark.parametrize("angle", np.linspace(0.0, np.pi / 2, 7))
def test_over_free_ground_time_is_distance_over_speed(angle: float) -> None:
    free, away = np.ones((SIZE, SIZE), bool), 100.0
    x, y = 20.5 + away * math.cos(angle), 20.5 + away * math.sin(angle)
    step = first_step(free, disc(x, y, 3.0), (20, 20), np.arange(60.0))
    assert (away - 3.0) / STRIDE / 1.04 - 1 <= step <= math.ceil(away / STRIDE)


def test_a_wall_is_gone_round() -> None:
    free = np.ones((SIZE, SIZE), bool)
    free[:100, 70:80] = False
    step = first_step(free, disc(120.5, 20.5, 2.0), (20, 20), np.arange(99.0))
    way = math.hypot(50, 80) + 10 + math.hypot(40, 80)
    assert 0.9 * way / STRIDE <= step <= way / STRIDE + 2
    free[:, 70:80] = False
    assert first_step(free, disc(120.5, 20.5, 2.0), (20, 20), np.arange(99.0)) == -1


def test_who_stands_in_a_corridor_is_waited_for() -> None:
    free = np.zeros((SIZE, SIZE), bool)
    free[70:81, :] = True
    goes = np.array([[[80.0, 75.5]]] * 40 + [[[80.0, -1000.0]]] * 40)
    step = first_step(
        free, disc(140.5, 75.5, 3.0), (75, 20), np.arange(80.0), Walkers(goes, np.zeros(1), 0.0, 1.0), [9.0]
    )
    assert step == pytest.approx(39 + (140 - 71 - 3) / STRIDE, abs=2)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6))
def test_nobody_who_touches_nothing_is_ever_earlier(seed: int) -> None:
    """Wander at any speed among people; whoever was never met has taken at least the earliest time."""
    random = np.random.default_rng(seed)
    begin = random.uniform(30, 120, (1, 6, 2))
    people = begin + np.cumsum(random.normal(0.0, 2.0, (60, 6, 2)), axis=0)
    radii, rounded = random.uniform(6.0, 12.0, 6), 1.0
    position, heading = random.uniform(30, 120, 2), random.uniform(-np.pi, np.pi)
    start = int(position[1]), int(position[0])
    parts, places = 8, []
    if (np.hypot(*(people[0] - position).T) < radii).any():
        return  # it touches a person where it starts
    for k in range(59 * parts):
        heading += random.normal(0.0, 0.3)
        speed = STRIDE / parts * random.choice((1.0, 1.0, 0.3))
        position = position + speed * np.array((np.cos(heading), np.sin(heading)))
        row, share = divmod((k + 1) / parts, 1.0)
        there = people[int(row)] * (1 - share) + people[min(int(row) + 1, 59)] * share
        inside = (position > 2).all() and (position < SIZE - 2).all()
        if (np.hypot(*(there - position).T) < radii).any() or not inside:
            break
        places.append(position)
    steps = len(places) // parts
    if steps == 0:
        return
    goal = disc(*places[steps * parts - 1], rounded)
    walkers = Walkers(people, np.zeros(6), 0.0, 1.0)
    found = first_step(np.ones((SIZE, SIZE), bool), goal, start, np.arange(60.0), walkers, radii - rounded)
    assert found in range(steps + 1)


def test_both_ways_of_counting_agree() -> None:
    random = np.random.default_rng(3)
    people = Walkers(
        random.uniform(20, 130, (1, 8, 2)) + np.cumsum(random.normal(0, 3, (40, 8, 2)), 0), np.zeros(8), 0.0, 1.0
    )
    free, radii, instants = np.ones((SIZE, SIZE), bool), np.full(8, 12.0), np.arange(40.0)
    free[40:110, 70:75] = False
    goal = disc(130.5, 75.5, 10.0)
    forward = first_step(free, goal, (75, 45), instants, people, radii)
    values = goal_values(SIZE, SIZE, 130.5, 75.5, 10.0)
    layers = np.empty((40, SIZE, SIZE), np.uint16)
    layers[-1] = static_times(free, values)
    times_to_go(layers, Course(free, values, instants, Moving(people, radii, STRIDE)), 0)
    assert forward == pytest.approx((layers[0, 75, 45] - FINE) / FINE, abs=1.5)
    assert layers[0, 75, 72] == NEVER


def test_a_robot_begins_at_rest() -> None:
    clock = Clock(0.5, 2.0, 2.5)
    instants = clock.instants(20)
    travelled = np.where(instants < 0.8, 1.25 * instants**2, 2.0 * instants - 0.8)
    assert travelled == pytest.approx(0.5 * np.arange(21))
    assert clock.steps_in(instants[7] + 1e-9) == 7
    assert clock.steps_in(instants[1] + 1e-9) == 1
