"""What an episode is worth to a search, on records of known outcome."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from arena_break.course import Draft
from arena_break.judging import KINDS, Trial, fails, kind_of, worth_of
from arena_core.testing import record
from arena_reference.causes import Cause


@dataclass(frozen=True)
class Told:
    """An episode by its record, or by what ended it."""

    made: object = None
    error: str = ""
    strict: bool = False

    def record(self):
        return self.made


def driven(outcome, *, contact):
    made = record(31, contact=contact)
    return Told(replace(made, meta={**made.meta, "outcome": outcome, "error": ""}))


DRAFT = Draft(None, record(31)["pose"][:, :2])
STRICT = driven("goal_reached", contact=False)
HIT = driven("goal_reached", contact=True)


def test_a_success_is_worth_less_the_more_room_it_had():
    worth = worth_of(DRAFT, Trial(STRICT), 3.0)
    clear = max(float(np.min(STRICT.record()["clearance_people"])), 0.0)
    assert worth.objective == -min(clear, 1.0)
    assert (worth.kind, worth.hard) == (0, False)


def test_a_failure_under_every_seed_is_worth_what_the_clairvoyant_has_to_spare():
    some, every = (worth_of(DRAFT, Trial(HIT, share, 0.4), 3.0) for share in (2.0 / 3.0, 1.0))
    assert (some.objective, some.hard) == (2.0 / 3.0, False)
    assert (every.objective, every.hard) == (1.4, True)
    assert every.kind > 0
    assert 0.0 <= every.place <= 1.0


def test_what_the_clairvoyant_does_not_get_through_is_worth_less_than_any_success():
    worth = worth_of(DRAFT, Trial(HIT, 1.0, None), 3.0)
    assert (worth.objective, worth.kind, worth.hard) == (-1.5, 0, False)
    assert worth_of(None, Trial(None), 3.0).objective == worth_of(DRAFT, Trial(None), 3.0).objective == -2.0


def test_an_error_of_the_planner_is_a_failure():
    worth = worth_of(DRAFT, Trial(Told(error="ValueError: no"), 1.0, 0.3), 3.0)
    assert (worth.objective, KINDS[worth.kind]) == (1.3, "other")


@pytest.mark.parametrize(
    ("what", "whom", "kind"),
    [
        ("ran into", "person 2", "ran into a person"),
        ("ran into", "a wall", "wall or obstacle"),
        ("was run into while driving", "person 0", "was run into"),
        ("was run into while standing", "person 0", "was run into while standing"),
        ("too slow", "", "other"),
    ],
)
def test_every_cause_has_its_kind(what, whom, kind):
    assert KINDS[kind_of(Cause(what, whom, 1.0))] == kind


def test_a_problem_fails_where_it_was_driven_under_every_seed_and_never_with_strict_success():
    lost, won = Told(), Told(strict=True)
    assert fails([{"a": lost}, {"a": lost}], "a")
    assert not fails([{"a": lost}, {"a": won}], "a")
    assert not fails([{"a": lost}, {}], "a")
