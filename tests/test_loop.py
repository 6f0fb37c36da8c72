from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arena_core import Contact, Crowd, ImpossibleScenario, Pose, Scenario, Simulator, Snapshot
from arena_core.hosting import CommandQueue, EpisodeLoop
from arena_core.loop.episode_loop import join_snapshots
from arena_core.scenes import Door
from arena_core.testing import robot, scan, scenario

TOUCH = Contact(1.0, "wall", -1, 0.5, True, 0.0, 0.0)


class Glide(Simulator):
    """Moves robots along x, at once as fast as they are told; ``contacts`` begin in every call of ``advance``."""

    inner_step = 0.02

    def __init__(self, contacts: tuple[tuple[Contact, ...], ...] = ((),)) -> None:
        self.contacts = contacts
        self.poses, self.stamps = np.zeros((len(contacts), 3)), np.zeros(len(contacts))

    def reset(self, scenarios: list[Scenario], slots: np.ndarray | None = None) -> Snapshot:
        slots = np.arange(len(self.poses)) if slots is None else slots
        self.poses[slots], self.stamps[slots] = [problem.start.array() for problem in scenarios], 0.0
        return self.snapshot(0, tuple(() for _ in self.poses))

    def advance(self, commands: np.ndarray, ticks: int) -> Snapshot:
        self.poses = self.poses + commands * (1.0, 0.0, 0.0) * ticks * self.inner_step
        self.stamps = self.stamps + ticks * self.inner_step
        return self.snapshot(ticks, self.contacts)

    def snapshot(self, ticks: int, contacts: tuple[tuple[Contact, ...], ...]) -> Snapshot:
        n = len(self.poses)
        nobody = Crowd(
            *(np.zeros(n, np.int32), np.zeros((n, 0), np.int32), np.zeros((n, 0, 2)), np.zeros((n, 0, 2))),
            *(np.zeros((n, 0)), np.zeros((n, 0), np.int8)),
        )
        header = scan(Pose(0.0, 0.0), robot())
        still, stamps = np.zeros((n, 3)), self.stamps.copy()
        return Snapshot(
            *(
                stamps,
                self.poses.copy(),
                still,
                nobody,
                np.ones(n),
                np.full(n, np.inf),
                np.zeros(n, np.bool_),
                np.full(n, 0.01 * ticks),
            ),
            *(contacts, np.tile(header.ranges, (n, 1)), stamps, stamps, self.poses.copy(), still, header),
        )


def loop_of(contacts: tuple[tuple[Contact, ...], ...] = ((),), collisions_to_end: int | None = None) -> EpisodeLoop:
    episodes = EpisodeLoop(Glide(contacts), 0.1, len(contacts), collisions_to_end)
    episodes.begin([scenario()] * len(contacts))
    return episodes


@given(
    steps=st.integers(1, 10),
    delays=st.lists(st.lists(st.integers(0, 35), min_size=2, max_size=2), min_size=1, max_size=20),
)
def test_commands_act_when_their_delay_is_over_and_none_that_was_overtaken_comes_back(steps, delays):
    queue, acted = CommandQueue(2), []
    for k, delay in enumerate(delays):
        queue.send(np.full((2, 3), k + 1.0), np.array(delay))
        acted += [commands[:, 0].tolist() for commands, ticks in queue.segments(steps) for _ in range(ticks)]
    for robot_ in range(2):
        sent = [(k * steps, k * steps + delay[robot_]) for k, delay in enumerate(delays)]
        due = [
            [k + 1.0 for k, (since, at) in enumerate(sent) if since <= tick and at <= tick]
            for tick in range(len(delays) * steps)
        ]
        assert [row[robot_] for row in acted] == [commands[-1] if commands else 0.0 for commands in due]


@given(length=st.integers(1, 20), delays=st.lists(st.integers(0, 30), min_size=1, max_size=4))
def test_segments_are_never_empty_and_fill_the_interval(length, delays):
    queue = CommandQueue(len(delays))
    queue.send(np.ones((len(delays), 3)), np.array(delays))
    ticks = [n for _, n in queue.segments(length)]
    assert min(ticks) >= 1
    assert sum(ticks) == length


def test_a_robot_whose_commands_are_forgotten_stands_and_the_others_go_on():
    queue = CommandQueue(2)
    queue.send(np.ones((2, 3)), np.zeros(2, np.int64))
    queue.send(np.full((2, 3), 2.0), np.full(2, 3))
    queue.clear(np.array([1]))
    assert [(commands[:, 0].tolist(), ticks) for commands, ticks in queue.segments(5)] == [
        ([1.0, 0.0], 3),
        ([2.0, 0.0], 2),
    ]


@pytest.mark.parametrize(
    ("claims", "x", "stamp", "contacts", "collisions_to_end", "outcome"),
    [
        (True, 1.5, 5.0, (), None, "goal_reached"),
        (True, 1.5 - 0.54, 5.0, (), None, "goal_reached"),
        (True, 1.5 - 0.56, 5.0, (), None, "false_arrival"),
        (True, 1.5, 60.0, (), None, "goal_reached"),
        (True, 1.5, 5.0, (TOUCH,), 1, "goal_reached"),
        (False, 1.5, 5.0, (), None, None),
        (False, 0.0, 59.8, (), None, None),
        (False, 0.0, 60.0, (), None, "time_out"),
        (False, 0.0, 5.0, (TOUCH,), None, None),
        (False, 0.0, 5.0, (TOUCH,), 2, None),
        (False, 0.0, 5.0, (TOUCH,), 1, "collision"),
        (False, 0.0, 5.0, (TOUCH, TOUCH), 2, "collision"),
        (False, 0.0, 60.0, (TOUCH,), 1, "collision"),
    ],
)
def test_an_episode_ends_as_the_table_says_whoever_drives_beside_it(
    claims, x, stamp, contacts, collisions_to_end, outcome
):
    episodes = loop_of((contacts, ()), collisions_to_end)
    simulator = episodes._simulator
    simulator.stamps = np.array((stamp - 0.1, 0.0))
    simulator.poses[0, 0] = x
    episodes.drive(np.zeros((2, 3)))
    verdicts = episodes.judge(np.array((claims, False)))
    assert verdicts.outcome(0) == outcome
    assert verdicts.outcome(1) is None


def test_an_episode_that_begins_anew_forgets_its_collisions_and_commands_under_way():
    episodes = loop_of(((TOUCH,), (TOUCH,)))
    episodes.drive(np.ones((2, 3)), np.array((7, 7)))
    episodes.begin([scenario()], np.array([1]))
    assert episodes.collisions.tolist() == [1, 0]
    start = scenario().start.x
    assert episodes.drive(np.zeros((2, 3)), np.full(2, 50)).poses[:, 0] == pytest.approx([start + 0.06, start])


def test_joining_keeps_the_last_instant_all_contacts_and_the_whole_time_in_contact():
    simulator = Glide(((TOUCH,), ()))
    simulator.reset([scenario()] * 2)
    snapshots = [simulator.advance(np.ones((2, 3)), n) for n in (2, 3)]
    whole = join_snapshots(snapshots)
    assert whole.poses.tolist() == snapshots[1].poses.tolist()
    assert whole.contacts == ((TOUCH, TOUCH), ())
    assert whole.contact_times == pytest.approx([0.05, 0.05])
    assert join_snapshots(snapshots[:1]) is snapshots[0]


def test_doors_in_a_simulator_that_has_none_are_impossible() -> None:
    leaf = Door(np.array([[1.0, 1.0], [2.0, 1.0], [2.0, 1.1]]), np.array([[3.0, 5.0]]))
    episodes = EpisodeLoop(Glide(((),)), 0.1, 1, None)
    with pytest.raises(ImpossibleScenario, match="sample/0: has doors, and Glide has none; allowed: scenarios without"):
        episodes.begin([replace(scenario(), doors=(leaf,))])
