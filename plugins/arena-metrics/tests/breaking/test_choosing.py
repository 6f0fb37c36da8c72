"""Which of the hard problems of a search are kept."""

from dataclasses import dataclass

from arena_break.choosing import choose
from arena_break.course import Draft
from arena_break.judging import Worth
from arena_break.searching import Found
from arena_core import Pose


@dataclass(frozen=True)
class Ends:
    """A problem by its name, start and goal."""

    name: str
    start: Pose
    goal: Pose


def found(name, kind, clear, x, place=0.1):
    return Found(Draft(Ends(name, Pose(x, 0.0), Pose(x, 9.0)), None), Worth(1.0 + clear, kind, 1, place))


def test_kinds_of_failure_take_turns_and_those_with_most_room_come_first():
    hard = [found("a", 1, 0.2, 0), found("b", 1, 0.5, 2), found("c", 2, 0.1, 4), found("d", 1, 0.3, 6)]
    assert [one.draft.problem.name for one in choose(hard, 3)] == ["b", "c", "d"]


def test_places_along_the_way_take_turns_within_a_kind():
    hard = [found("a", 1, 0.9, 0), found("b", 1, 0.8, 2), found("c", 1, 0.2, 4, place=0.9)]
    assert [one.draft.problem.name for one in choose(hard, 2)] == ["a", "c"]


def test_no_two_have_the_same_start_and_goal():
    hard = [found("a", 1, 0.9, 0), found("b", 1, 0.8, 0.5), found("c", 2, 0.7, 0.2), found("d", 2, 0.1, 3)]
    assert [one.draft.problem.name for one in choose(hard, 9)] == ["a", "d"]
    assert choose([], 3) == []
