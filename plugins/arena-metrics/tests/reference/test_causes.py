"""Why episodes fail, on records of known cause."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import EpisodeRecord
from arena_core.testing import record
from arena_reference.causes import cause_of


def changed(outcome: str, arrays: dict | None = None, error: str = "", *, contact: bool = False) -> EpisodeRecord:
    """Return the record of a drive of 30 steps that ended otherwise."""
    made = record(31, contact=contact)
    meta = {**made.meta, "outcome": outcome, "error": error}
    return replace(made, meta=meta, arrays={**made.arrays, **(arrays or {})})


def twists(vx: np.ndarray, wz: float = 0.0) -> np.ndarray:
    return np.column_stack((vx, np.zeros(31), np.full(31, wz)))


STAND, DRIVE = np.zeros(31), np.full(31, 1.0)
TO_AND_FRO = np.where(np.arange(31) // 5 % 2, -0.5, 0.5)
LEFT_LATE = np.r_[np.zeros(20), np.ones(11)][:, None] * (1.0, 0.0, 0.0)


def collided(kind: int = 2, *, caused: bool, twist: np.ndarray = DRIVE) -> EpisodeRecord:
    kinds = {"contact_kind": np.array((kind,), np.int8), "contact_caused": np.array((caused,))}
    return changed("goal_reached", {**kinds, "twist": twists(twist)}, contact=True)


def met(speed: float, walks: float, *, twist: np.ndarray | None = None) -> EpisodeRecord:
    """Return a contact with a person straight ahead who walks at the robot at a speed, m/s; both moved together."""
    made = changed("goal_reached", contact=True)
    row = int(np.searchsorted(made["stamp"], made["contact_stamp"][0])) - 1
    place = made["pose"][row, :2]
    people = np.tile(np.float32(np.add(place, (0.6, 0.0))), (31, 1, 1))
    arrays = {
        **{"contact_caused": np.array((True,)), "contact_position": np.add(place, (0.3, 0.0))[None]},
        **{"pedestrian_positions": people, "pedestrian_velocities": np.tile(np.float32((-walks, 0.0)), (31, 1, 1))},
        **{"twist": twists(np.full(31, speed)) if twist is None else twist, "pose": np.tile((*place, 0.0), (31, 1))},
    }
    return replace(made, arrays={**made.arrays, **arrays})


SPINS = np.column_stack((np.zeros(31), np.zeros(31), np.full(31, 1.0)))


@pytest.mark.parametrize(
    ("failed", "what"),
    [
        (met(0.5, 0.2), "ran into"),
        (met(0.5, -0.1), "ran into"),
        (met(0.06, 0.25), "was run into while driving"),
        (met(-0.1, 0.3), "was run into while driving"),
        (met(0.0, 0.3), "was run into while standing"),
        (met(0.0, 0.3, twist=SPINS), "was run into while standing"),
    ],
)
def test_who_brought_more_of_the_speed_ran_into_the_other(failed: EpisodeRecord, what: str) -> None:
    cause = cause_of(failed)
    assert cause is not None
    assert cause.what == what


@pytest.mark.parametrize(
    ("failed", "what", "whom"),
    [
        (collided(caused=True), "ran into", "person 1"),
        (collided(0, caused=True), "ran into", "a wall"),
        (collided(1, caused=True), "ran into", "an obstacle"),
        (collided(caused=False), "was run into while driving", "person 1"),
        (collided(caused=False, twist=STAND), "was run into while standing", "person 1"),
        (changed("time_out", {"twist": twists(STAND)}), "stood too long", ""),
        (changed("time_out", {"twist": twists(TO_AND_FRO)}), "oscillated", ""),
        (changed("time_out", {"twist": twists(DRIVE)}), "too slow", ""),
        (changed("time_out", {"twist": twists(STAND, wz=1.0)}), "too slow", ""),
        (changed("false_arrival"), "lost its pose", ""),
        (changed("error", error="no path from start to goal"), "no path", ""),
        (changed("error", error="ValueError: 3"), "error", ""),
    ],
)
def test_causes_are_told_apart(failed: EpisodeRecord, what: str, whom: str) -> None:
    cause = cause_of(failed)
    assert cause is not None
    assert (cause.what, cause.whom) == (what, whom)


def test_a_strict_success_has_no_cause() -> None:
    assert cause_of(record()) is None


def test_the_first_contact_decides() -> None:
    cause = cause_of(collided(caused=True))
    assert cause is not None
    assert cause.stamp == record(31, contact=True)["contact_stamp"][0]


def test_a_pose_is_lost_from_when_it_stays_off() -> None:
    made = record()
    off = changed("time_out", {"estimate": made["estimate"] + LEFT_LATE, "twist": twists(STAND)})
    cause = cause_of(off)
    assert cause is not None
    assert (cause.what, cause.stamp) == ("lost its pose", pytest.approx(2.0))
