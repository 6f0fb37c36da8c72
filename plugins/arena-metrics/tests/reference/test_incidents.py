"""Recoveries, stands and reversals with their reasons, on records of known cause."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from arena_core import EpisodeRecord
from arena_core.testing import record
from arena_reference.incidents import incidents_of

STEPS = 101


def driven(speeds: np.ndarray, told: np.ndarray | None = None, events: tuple = (), gap: float = 9.0, side: float = 0.0):
    """Return a record of a robot at the origin with these speeds (T,), which was ``told`` to drive at others.

    A person stands ``gap`` m from it, on the side with the bearing ``side``, rad.
    """
    made = record(STEPS)
    place = 1.0 * np.array((np.cos(side), np.sin(side)))
    zeros = np.zeros(STEPS)
    arrays = {
        "pose": np.zeros((STEPS, 3)),
        "twist": np.column_stack((speeds, zeros, zeros)),
        "command": np.column_stack((speeds if told is None else told, zeros, zeros)),
        "clearance": np.full(STEPS, gap),
        "clearance_people": np.full(STEPS, gap),
        "pedestrian_positions": np.tile(place.astype(np.float32), (STEPS, 1, 1)),
    }
    config = {"recoveries": {"lean_time": 3.0}}
    told_events = [{"stamp": stamp, "kind": kind, "detail": detail} for stamp, kind, detail in events]
    return replace(made, arrays={**made.arrays, **arrays}, meta={**made.meta, "events": told_events, "config": config})


def said(made: EpisodeRecord) -> list[str]:
    return [f"{one.stamp:.1f} {one.sentence()}" for one in incidents_of(made)]


FORTH = np.full(STEPS, 0.2)
PAUSE = np.where((np.arange(STEPS) >= 20) & (np.arange(STEPS) < 60), 0.0, 0.2)
SHORT = np.where((np.arange(STEPS) >= 20) & (np.arange(STEPS) < 45), 0.0, 0.2)
BACK = np.where(np.arange(STEPS) < 30, 0.2, -0.2)
TO_AND_FRO = np.where(np.arange(STEPS) // 10 % 2, -0.2, 0.2)


@pytest.mark.parametrize(
    ("made", "found"),
    [
        (driven(FORTH), []),
        (driven(SHORT), []),
        (driven(PAUSE), ["2.0 stood 4.0 s: nothing was near"]),
        (driven(PAUSE, gap=0.4), ["2.0 stood 4.0 s: person 1 0.4 m ahead"]),
        (driven(PAUSE, gap=0.4, side=2.0), ["2.0 stood 4.0 s: person 1 0.4 m to the left"]),
        (driven(PAUSE, told=FORTH, gap=0.0), ["2.0 stood 4.0 s: was told to drive; person 1 0.0 m ahead"]),
        (
            driven(PAUSE, events=((3.0, "no_valid_command", "all trajectories collide"),)),
            ["2.0 stood 4.0 s: the planner found no command (all trajectories collide)"],
        ),
        (
            driven(PAUSE, events=((1.9, "recovery", "wait: no progress for 10.0 s"),)),
            ["1.9 recovery wait: no progress for 10.0 s", "2.0 stood 4.0 s: a recovery waited"],
        ),
        (
            driven(FORTH, events=((3.0, "recovery", "back_up: leans on something"),), gap=0.02, side=3.1),
            ["3.0 recovery back_up: leaned 3 s on person 1"],
        ),
        (
            driven(FORTH, events=((3.0, "recovery", "clear: no progress for 10.0 s"),), gap=0.5),
            ["3.0 recovery clear: no progress for 10.0 s; person 1 0.5 m away"],
        ),
        (driven(BACK, gap=0.3), ["3.0 reversed backwards: person 1 0.3 m ahead"]),
        (driven(-BACK, gap=0.3, side=3.1), ["3.0 reversed forwards: person 1 0.3 m behind"]),
        (
            driven(BACK, events=((2.9, "recovery", "back_up: no progress for 10.0 s"),)),
            ["2.9 recovery back_up: no progress for 10.0 s", "3.0 reversed backwards: recovery back_up"],
        ),
        (driven(TO_AND_FRO), ["1.0 reversed 10 times in 9.0 s: nothing was near"]),
    ],
)
def test_what_held_a_robot_up_is_said_with_its_reason(made: EpisodeRecord, found: list[str]) -> None:
    assert said(made) == found
