"""What a certificate says of an episode, number by number."""

import math
from dataclasses import replace

import pytest

from arena_core import EpisodeRecord
from arena_core.records import read_findings
from arena_core.testing import record
from arena_reference.certifying import people_react
from arena_reference.findings import compare, keep_findings, known_problems


def of_length(steps: int, *, contact: bool = False, **notes: float | str) -> EpisodeRecord:
    """Return a record of so many control periods of 0.1 s, with these notes."""
    made = record(steps + 1, contact=contact)
    return replace(made, meta={**made.meta, "notes": notes})


def finding(of: EpisodeRecord, certificate: EpisodeRecord, *, reacts: bool = False):
    return compare(7, of, [certificate], "digest", reacts=reacts)


def test_a_certificate_of_a_team_is_one_only_if_all_its_robots_succeed() -> None:
    own, mate = of_length(28, time_lower=2.5), of_length(31, time_lower=3.0)
    whole, touching = (
        compare(7, of_length(33), [mate, second, own], "digest", reacts=False)  # robot 1 of 3
        for second in (own, of_length(28, contact=True, time_lower=2.5))
    )
    assert (whole.solvable, whole.time_certified) == ("yes", pytest.approx(2.8))
    assert compare(6, of_length(33), [mate, own, own], "digest", reacts=False).time_certified == pytest.approx(3.1)
    assert (touching.solvable, touching.time_lower) == ("unknown", 2.5)
    assert compare(6, of_length(33), [mate, own, None], "digest", reacts=False).solvable == "unknown"


def test_a_strict_success_has_a_regret_and_a_share_of_the_best_time() -> None:
    found = finding(of_length(33), of_length(28, time_lower=2.5, time_lower_static=2.0))
    assert (found.solvable, found.episode, found.avoidable) == ("yes", 7, 0.0)
    assert found.time_certified == pytest.approx(2.8)
    assert found.time_regret == pytest.approx(0.5)
    assert found.stl == pytest.approx(2.8 / 3.3)
    assert found.time_lower == 2.5


def test_who_is_faster_than_the_certificate_has_a_share_of_one() -> None:
    found = finding(of_length(28), of_length(33, time_lower=2.5))
    assert found.stl == 1.0
    assert found.time_regret == pytest.approx(-0.5)


def test_a_contact_where_a_certificate_exists_was_avoidable() -> None:
    found = finding(of_length(30, contact=True), of_length(30, time_lower=2.5))
    assert (found.avoidable, found.stl) == (1.0, 0.0)
    assert math.isnan(found.time_regret)


@pytest.mark.parametrize(("lower", "solvable"), [("inf", "no"), (2.5, "unknown")])
def test_without_a_certificate_only_the_bound_says_no(lower: float | str, solvable: str) -> None:
    found = finding(of_length(30, contact=True), of_length(30, contact=True, time_lower=lower))
    assert found.solvable == solvable
    assert all(math.isnan(value) for value in (found.stl, found.avoidable, found.time_regret))


def test_among_people_who_react_the_bound_is_that_of_the_walls() -> None:
    certificate = of_length(28, time_lower=2.5, time_lower_static=2.0)
    assert finding(of_length(33), certificate, reacts=True).time_lower == 2.0
    assert people_react({"pedestrians": {"name": "social_force", "reaction": "yield"}})
    assert not people_react({"pedestrians": {"name": "none"}})


def test_what_is_kept_beside_records_is_read_as_it_was_written(tmp_path) -> None:
    assert known_problems(tmp_path) == {}
    other = replace(finding(of_length(3, contact=True), of_length(3)), episode=8)
    keep_findings(tmp_path, [finding(of_length(33), of_length(28, time_lower=2.5)), other], "abc")
    (kept,) = read_findings(tmp_path)
    assert (kept.kind, kept.code, known_problems(tmp_path)) == ("reference", "abc", {7: "digest", 8: "digest"})
    assert kept.rows[7]["solvable"] == "yes"
    assert kept.rows[7]["time_certified"] == pytest.approx(2.8)
    assert math.isnan(kept.rows[8]["stl"])
