"""Broadcast: who hears whom, when, and for how long."""

import numpy as np
import pytest

from arena_core import Pose, Twist, random_generator
from arena_core.tasks import Message
from arena_core.testing import check, component, robot

PERIOD = 0.1  # s


def radio(*overrides, robots=2, scenario="test"):
    built = component("communication", "broadcast", [f"communication.{word}" for word in overrides])
    built.reset(robots, random_generator(0, scenario, "communication"))
    return built


def tell(built, step, *places, silent=()):
    """Let robots at places (x, y) m tell of themselves at a control step."""
    said = [
        None if k in silent else Message(k, PERIOD * step, Pose(*place), Twist(0.5), np.zeros((3, 3)), 0.3)
        for k, place in enumerate(places)
    ]
    built.tell(said, np.array(places))


def stamps(built, member, step):
    return {message.sender: round(message.stamp, 6) for message in built.heard(member, PERIOD * step)}


def test_it_keeps_the_contract():
    assert check("communication", component("communication", "broadcast"), robot())


def test_a_message_comes_when_its_delay_is_over_and_counts_for_its_memory():
    built = radio("loss=0", "delay=0.3", "memory=0.5")
    tell(built, 0, (0.0, 0.0), (1.0, 0.0))
    heard = [stamps(built, 0, step) for step in range(8)]
    assert heard == [{}, {}, {}, {1: 0.0}, {1: 0.0}, {1: 0.0}, {}, {}]


def test_the_newest_message_takes_the_place_of_older_ones():
    built = radio("loss=0", "delay=0")
    for step in range(3):
        tell(built, step, (0.0, 0.0), (1.0, 0.0))
        assert stamps(built, 1, step + 1) == {0: round(PERIOD * step, 6)}


def test_robots_out_of_range_hear_nothing_whatever_stands_between_the_others():
    built = radio("loss=0", "delay=0", "range=5", robots=3)
    tell(built, 0, (0.0, 0.0), (4.9, 0.0), (9.8, 0.0))
    assert [set(stamps(built, k, 1)) for k in range(3)] == [{1}, {0, 2}, {1}]


def test_who_is_silent_is_forgotten():
    built = radio("loss=0", "delay=0", "memory=0.25")
    tell(built, 0, (0.0, 0.0), (1.0, 0.0))
    for step in range(1, 4):
        tell(built, step, (0.0, 0.0), (1.0, 0.0), silent=(1,))
    assert (stamps(built, 0, 4), stamps(built, 1, 4)) == ({}, {0: 0.3})


def lost(built, steps, silent=()):
    """Return at which steps robot 0 did not hear robot 1, and robot 1 not robot 0."""
    missed = ([], [])
    for step in range(steps):
        tell(built, step, (0.0, 0.0), (1.0, 0.0), silent=silent)
        for member in (0, 1):
            if stamps(built, member, step + 1).get(1 - member) != round(PERIOD * step, 6):
                missed[member].append(step)
    return missed


def test_the_share_of_messages_that_get_lost_is_as_configured():
    first, second = lost(radio("loss=0.3", "delay=0"), 2000)
    assert len(first) / 2000 == pytest.approx(0.3, abs=0.03)  # three standard deviations
    assert first != second


def test_which_messages_get_lost_depends_on_the_scenario_and_not_on_who_tells():
    first, second = lost(radio("loss=0.3", "delay=0"), 100)
    assert lost(radio("loss=0.3", "delay=0"), 100) == (first, second)
    assert lost(radio("loss=0.3", "delay=0"), 100, silent=(0,))[0] == first
    assert lost(radio("loss=0.3", "delay=0", scenario="other"), 100)[0] != first
