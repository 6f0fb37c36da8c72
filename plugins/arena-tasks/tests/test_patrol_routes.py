"""People of random tasks walk rounds that are metres long, on ways that exist, in parties and at speeds as asked."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from omegaconf import OmegaConf

from arena_core import OccupancyGrid, PedestrianSpec, Pose, Scenario, World, WorldSource, testing
from arena_core.hosting import Registry, compose, load_registry, to_plain
from arena_kernels.shortest_path import ShortestPaths
from arena_tasks.random.patrol_routes import SNAP

EXACT = settings(derandomize=True, deadline=None, max_examples=20)


class Fixed(WorldSource):
    def __init__(self, grid: OccupancyGrid) -> None:
        self._world = World("fixed", grid)

    def world(self, seed: int, index: int) -> World:
        return self._world


def house() -> OccupancyGrid:
    """Return four rooms of 8 x 8 m, joined by doors of 1.2 m."""
    data = np.zeros((160, 160), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    data[79:81] = data[:, 79:81] = 100
    for door in (40, 120):
        data[79:81, door - 6 : door + 6] = data[door - 6 : door + 6, 79:81] = 0
    return OccupancyGrid(data, 0.1, Pose(0.0, 0.0))


HOUSE = house()


@cache
def usual() -> tuple[Registry, Any]:
    return load_registry(), compose(["task=random"], "component")["task"]


def draw(index: int = 0, seed: int = 0, grid: OccupancyGrid = HOUSE, **changes: object) -> Scenario:
    registry, figures = usual()
    node = to_plain(OmegaConf.merge(figures, changes))
    scenario: Scenario = registry.build("task", node, robot=testing.robot(), world=Fixed(grid)).scenario(seed, index)
    return scenario


def span(person: PedestrianSpec) -> float:
    return float(np.hypot(*np.ptp(np.vstack((person.waypoints_xy, person.position_xy[None])), axis=0)))


def legs_of(person: PedestrianSpec) -> np.ndarray:
    return np.hypot(*(person.waypoints_xy - np.roll(person.waypoints_xy, 1, axis=0)).T)


@EXACT
@given(
    st.integers(0, 2**31),
    st.sampled_from(["along_route", "anywhere"]),
    st.floats(0.0, 1.0),
    st.integers(2, 5),
    st.floats(1.0, 6.0),
    st.floats(0.0, 6.0),
)
def test_every_leg_is_as_long_as_asked_and_has_a_way(
    seed: int, placement: str, crossing: float, places: int, least: float, more: float
) -> None:
    limits = {"leg_min": least, "leg_max": least + 1.0 + more}
    rounds = {"crossing": crossing, "waypoints_min": places, "waypoints_max": places, **limits}
    people = draw(seed=seed, placement=placement, rounds=rounds).pedestrians
    for person in people:
        assert len(person.waypoints_xy) == 2 * places - 2  # there, and back the same way
        ways = HOUSE.derive(ShortestPaths).patrol_paths(person.waypoints_xy, person.radius)
        assert len(ways) == len(person.waypoints_xy)
        # each end snaps to a place with room
        assert span(person) >= (0.99 * least if placement == "anywhere" else least - 2.0 * SNAP)
        if placement == "anywhere":
            assert legs_of(person).min() >= least
            assert legs_of(person).max() <= least + 1.0 + more


def test_rounds_span_six_metres_and_more() -> None:
    spans = [span(person) for index in range(12) for person in draw(index).pedestrians]
    assert np.mean(spans) > 6.0
    assert np.min(spans) > 3.0


def test_who_walks_to_and_fro_comes_back_by_the_same_waypoints() -> None:
    for person in draw(rounds={"waypoints_min": 4}).pedestrians:
        stops = np.roll(
            person.waypoints_xy, -int(np.argmin(np.unique(person.waypoints_xy, axis=0, return_counts=True)[1])), axis=0
        )
        assert len(np.unique(stops, axis=0)) == 4
        assert any(
            np.array_equal(turned, turned[np.r_[0, len(turned) - 1 : 0 : -1]]) for turned in rolls(person.waypoints_xy)
        )
    for person in draw(rounds={"waypoints_min": 4, "to_and_fro": 0.0}).pedestrians:
        assert len(np.unique(person.waypoints_xy, axis=0)) == len(person.waypoints_xy) == 4


def rolls(waypoints: np.ndarray) -> list[np.ndarray]:
    return [np.roll(waypoints, k, axis=0) for k in range(len(waypoints))]


def test_a_room_too_small_for_a_leg_gets_half_of_what_there_is() -> None:
    for person in draw(grid=testing.room(5.0), pedestrians=3).pedestrians:
        assert legs_of(person).min() > 1.0


def test_a_share_of_the_people_walks_in_groups_on_one_round() -> None:
    people = draw(pedestrians=10, groups={"share": 0.6}, people={"speed_spread": 0.2}).pedestrians
    groups = {
        name: [p for p in people if p.behaviour.get("group") == name]
        for p in people
        if (name := p.behaviour.get("group")) is not None
    }
    assert sum(map(len, groups.values())) == 6
    assert all(2 <= len(members) <= 3 for members in groups.values())
    for members in groups.values():
        assert all(np.array_equal(member.waypoints_xy, members[0].waypoints_xy) for member in members)
        assert {member.desired_speed for member in members} == {members[0].desired_speed}
        assert all(np.hypot(*(member.position_xy - members[0].position_xy)) < 1.0 for member in members)
    assert [person.id for person in people] == list(range(10))


def test_speeds_have_the_mean_and_spread_that_are_asked_for() -> None:
    weidmann = {"speed": 1.34, "speed_spread": 0.194}
    people = [p for k in range(30) for p in draw(k, pedestrians=10, people=weidmann).pedestrians]
    speeds = np.array([person.desired_speed for person in people])
    assert speeds.mean() == pytest.approx(1.34, abs=0.05)
    assert speeds.std() == pytest.approx(0.26, abs=0.03)
    assert speeds.min() >= 1.34 * (1.0 - 2.5 * 0.194)


def test_manners_change_nobodys_round() -> None:
    usual_people = draw(3).pedestrians
    manners = {"children": 0.3, "pause_probability": 0.5, "speed_spread": 0.2, "respawn": True}
    for person, other in zip(usual_people, draw(3, people=manners).pedestrians, strict=True):
        assert np.array_equal(person.waypoints_xy, other.waypoints_xy)
        assert np.array_equal(person.position_xy, other.position_xy)
        assert other.behaviour["pause_probability"] == 0.5
        assert other.behaviour["pause_time"] == 10.0
