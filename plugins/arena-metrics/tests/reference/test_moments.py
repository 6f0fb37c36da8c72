"""The last avoidable moment, against closed forms."""

import numpy as np
import pytest

from arena_core import Branches, Pose
from arena_core.hosting import WorldTruth
from arena_reference.moments import HeldWorld, in_words, last_avoidable
from arena_reference.ways import Way


def drive_ahead(set_up, speed: float):
    """Return the worlds of each control step of a drive straight ahead, and when something is touched."""
    worlds, snapshot = [], set_up.loop.snapshot
    for _ in range(100):
        worlds.append(WorldTruth(HeldWorld(set_up.simulator.fork(Branches.of([0]))), 0, set_up.scenario))
        snapshot = set_up.loop.drive(np.array(((speed, 0.0, 0.0),)))
        if snapshot.contacts[0]:
            return worlds, snapshot.contacts[0][0].stamp
    raise AssertionError("nothing was touched")


def test_a_wall_can_be_avoided_for_as_long_as_brakes_need(stage) -> None:
    set_up = stage(start=Pose(1.0, 2.0, 0.0))
    worlds, contact = drive_ahead(set_up, 1.0)
    moment = last_avoidable(worlds, set_up.finder, contact)
    braking = 1.0 / (2.0 * set_up.robot.limits.ax_max)  # s at this speed for the way of the brakes
    assert moment.stamp is not None
    assert braking <= contact - moment.stamp <= braking + 0.2
    assert moment.way is not None
    assert in_words(moment.way).split(" to the")[0] in ("slowing down", "reversing", "stopping", "turning")


def test_who_comes_up_behind_can_be_driven_away_from(stage) -> None:
    """A person walks into a standing robot, which could have left until its own acceleration was too little."""
    set_up = stage(walks=(((-3.5, 0.0), (3.5, 0.0), 0.9),), start=Pose(-1.0, 0.0, 0.0))
    worlds, contact = drive_ahead(set_up, 0.0)
    moment = last_avoidable(worlds, set_up.finder, contact)
    meeting = 0.5 * 0.9 / set_up.robot.limits.ax_max  # s: until as fast as the person, who then is no nearer
    assert moment.stamp is not None
    assert meeting - 0.05 <= contact - moment.stamp <= meeting + 0.25


def test_there_is_no_moment_where_nothing_helps(stage) -> None:
    set_up = stage(start=Pose(1.0, 2.0, 0.0))
    worlds, contact = drive_ahead(set_up, 1.0)
    assert last_avoidable(worlds[-1:], set_up.finder, contact).stamp is None


def way(vx: float, turned: float = 0.0, before: float = 1.0) -> Way:
    """Return a way of one second with a mean speed and a turn, of a robot that drove at ``before`` m/s."""
    states = np.zeros((11, 6))
    states[:, 2], states[:, 3] = np.linspace(0.0, turned, 11), vx
    middle = 0.5 * (states[1:, 2] + states[:-1, 2])
    states[1:, 0], states[1:, 1] = np.cumsum(0.1 * vx * np.cos(middle)), np.cumsum(0.1 * vx * np.sin(middle))
    states[0, 3] = before
    return Way(np.zeros((10, 3)), states, 0.0, 0.1, True)


@pytest.mark.parametrize(
    ("out", "words"),
    [
        (way(-0.3), "reversing"),
        (way(-0.3, before=-0.3), "reversing on"),
        (way(-0.3, 0.5), "reversing to the right"),  # its back swings there
        (way(-0.3, -0.5), "reversing to the left"),
        (way(0.0), "stopping"),
        (way(0.0, before=0.0), "standing"),
        (way(0.0, -1.0), "turning on the spot to the right"),
        (way(0.01, -1.0), "turning on the spot to the right"),
        (way(0.4), "slowing down"),
        (way(0.4, before=0.0), "driving off"),
        (way(0.4, 0.5, before=-0.2), "driving off to the left"),
        (way(1.0, 0.6), "turning to the left"),
        (way(1.0), "driving on"),
        (way(1.0, -0.1), "driving on"),
    ],
)
def test_ways_are_told_in_words(out: Way, words: str) -> None:
    assert in_words(out) == words
