"""Patrols: the graph over the free space, where strategies send robots, and graphs that are refused."""

import numpy as np
import pytest
from scipy.sparse.csgraph import connected_components

from arena_core import ConfigurationError, ImpossibleScenario
from arena_core.tasks import PatrolGraph
from arena_core.testing import component, robot
from arena_tasks.random.free_space import FreeSpace
from arena_tasks.teams.patrol_graph import GraphOfFreeSpace
from arena_tasks.teams.patrol_strategies import ConscientiousReactive, Cyclic

SQUARE = "task.graph={places: [[4, 4], [16, 4], [16, 16], [4, 16]], edges: [[0, 1], [1, 2], [2, 3], [3, 0]]}"


def world(name="empty", *overrides):
    return component("world", name, list(overrides))


def patrol(*overrides, of=None):
    return component("task", "patrol", list(overrides), robot=robot(), world=of or world())


def ring(count, side=1.0):
    """Return a graph whose places lie on a circle, each a neighbour of the next one."""
    angles = 2.0 * np.pi * np.arange(count) / count
    lengths = np.full((count, count), np.inf)
    for k in range(count):
        lengths[k, (k + 1) % count] = lengths[(k + 1) % count, k] = side
    return PatrolGraph(np.stack((np.cos(angles), np.sin(angles)), axis=1), lengths)


@pytest.mark.parametrize("name", ["empty", "door", "indoor", "rooms"])
def test_graph_of_free_space_is_connected_covers_it_and_keeps_off_walls(name):
    grid = world(name).world(0, 0).grid
    graph = grid.derive(GraphOfFreeSpace(3.0, 0.5))
    assert connected_components(np.isfinite(graph.lengths), directed=False)[0] == 1
    assert np.array_equal(graph.lengths, graph.lengths.T)
    space = grid.derive(FreeSpace)
    assert space.has_room(graph.places, 0.5).all()
    labels = space.regions(0.5)
    cells = grid.positions(np.argwhere(labels == np.bincount(labels[labels > 0]).argmax()))
    away = np.hypot(*(cells[:, None] - graph.places).transpose(2, 0, 1)).min(axis=1)
    assert away.max() <= 2.0**0.5 * 3.0 + 0.5 * 3.0  # m: across a square, to a place that took the square's own place


def test_conscientious_robot_goes_to_the_neighbour_that_was_idle_longest():
    choose = ConscientiousReactive().begin(ring(5), [0], np.random.default_rng(0))
    assert choose(0, 0, np.array([0.0, 3.0, 99.0, 99.0, 4.0])) == 4
    assert choose(0, 0, np.array([0.0, 5.0, 99.0, 99.0, 4.0])) == 1
    assert {choose(0, 0, np.zeros(5)) for _ in range(30)} == {1, 4}


def test_cyclic_robots_go_round_a_ring_in_one_sense():
    choose = Cyclic().begin(ring(6), [0, 3], np.random.default_rng(0))
    walks = []
    for member, at in ((0, 0), (1, 3)):
        walk = [at]
        for _ in range(6):
            walk.append(choose(member, walk[-1], np.zeros(6)))
        walks.append(walk)
    assert walks[0] in ([0, 1, 2, 3, 4, 5, 0], [0, 5, 4, 3, 2, 1, 0])
    assert np.array_equal(np.diff(walks[0][:3]) % 6, np.diff(walks[1][:3]) % 6)


def test_cyclic_robots_pass_a_place_twice_where_the_graph_is_a_line():
    line = ring(4)
    line.lengths[0, 3] = line.lengths[3, 0] = np.inf
    choose = Cyclic().begin(line, [0], np.random.default_rng(0))
    walk = [0]
    for _ in range(6):
        walk.append(choose(0, walk[-1], np.zeros(4)))
    assert walk == [0, 1, 2, 3, 2, 1, 0]


def test_a_cycle_is_no_longer_than_that_of_a_square_of_places():
    side = 4
    places = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2).astype(float)
    away = np.hypot(*(places[:, None] - places).transpose(2, 0, 1))
    graph = PatrolGraph(places, np.where(np.isclose(away, 1.0), away, np.inf))
    choose = Cyclic().begin(graph, [0], np.random.default_rng(0))
    walk, seen = [0], {0}
    while len(seen) < side**2:
        walk.append(choose(0, walk[-1], np.zeros(len(places))))
        seen.add(walk[-1])
    assert len(walk) <= 1.25 * side**2  # the least is side ** 2


def test_patrols_are_pure_functions_of_seed_and_index():
    task = patrol("task.team=3")
    one, same, other = task.scenario(1, 0), task.scenario(1, 0), task.scenario(1, 1)
    assert (one.start, one.goal, one.team) == (same.start, same.goal, same.team)
    assert one.errands.starts != other.errands.starts
    sent = [[begin(k % 3, 10.0 * k) for k in range(12)] for begin in (one.errands.begin(), one.errands.begin())]
    assert sent[0] == sent[1]
    assert one.goal.distance(one.start) > 0.0


def test_a_graph_may_be_given():
    scenario = patrol(SQUARE, "task.team=2").scenario(0, 0)
    assert scenario.errands.places.tolist() == [[4, 4], [16, 4], [16, 16], [4, 16]]
    assert scenario.goal.distance(scenario.start) == pytest.approx(12.0)


@pytest.mark.parametrize(
    ("graph", "said"),
    [
        ("{places: [[4, 4], [16, 4]]}", "task.graph is .*; allowed: null, or a mapping with places and edges"),
        ("{places: [[4, 4]], edges: [[0, 1]]}", "task.graph.places is no list of two places"),
        ("{places: [[4, 4], [16, 4]], edges: [[0, 2]]}", r"task.graph.edges join what is no place; .* 0 \.\. 1"),
        ("{places: [[4, 4], [16, 4]], edges: [0, 1]}", "task.graph.edges is no list of pairs"),
        ("{places: [[4, 4], [16, 4], [8, 8]], edges: [[0, 1]]}", "task.graph.edges leave places apart"),
    ],
)
def test_a_graph_that_is_none_is_refused_in_one_line(graph, said):
    with pytest.raises(ConfigurationError, match=said) as refused:
        patrol(f"task.graph={graph}")
    assert "\n" not in str(refused.value)


def test_too_few_places_for_a_team_are_one_line():
    with pytest.raises(ImpossibleScenario, match=r"40 robots patrol .* places of empty; allowed: as many"):
        patrol("task.team=40").scenario(0, 0)
    source = component("task", "delivery", ["task.team=12"], robot=robot(), world=world())
    with pytest.raises(ImpossibleScenario, match="12 robots have 12 stations in empty; allowed: more stations"):
        source.scenario(0, 0)
    with pytest.raises(ImpossibleScenario, match=r"place 1 of the graph has no room at"):
        patrol("task.graph={places: [[4, 4], [0, 0]], edges: [[0, 1]]}", "task.team=2").scenario(0, 0)


def test_no_two_robots_are_bound_for_one_station():
    errands = component("task", "delivery", ["task.team=5"], robot=robot(), world=world()).scenario(0, 0).errands
    bound, send = list(errands.bound_for), errands.begin()
    for step in range(50):
        before = bound[step % 5]
        bound[step % 5] = send(step % 5, float(step))
        assert len(set(bound)) == 5
        assert bound[step % 5] != before
