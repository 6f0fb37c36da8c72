"""Claims are judged as their contrasts say, on data whose truth is known."""

from pathlib import Path

import numpy as np
import pytest

from arena_core import ConfigurationError
from arena_metrics.claims.claim_verdicts import claims_table, judge_claims
from arena_metrics.claims.contrasts import contrast_findings
from arena_metrics.claims.model import Claim, Claims, Contrast, read_claims
from arena_metrics.pages.report import ReportCommand
from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.runs import Column, Episode, Run

COLUMNS = [
    Column("collisions", "", "-", "lower", "", False),
    Column("success", "", "0/1", "higher", "", False),
    Column("path_length", "", "m", "lower", "", True),
]
BY_NAME = {column.name: column for column in COLUMNS}


def rows(planner, robot="jackal", world="hall", people=5, n=30, collisions=0.0, success=1.0, length=10.0, spread=1.0):
    """Return n episodes whose problems are as hard for everybody; figures may be functions of the problem's number."""
    random = np.random.default_rng(7)
    hard = random.normal(0.0, 1.0, n)
    own = np.random.default_rng(sum(map(ord, planner + robot)) + people).normal(0.0, spread, n)

    def of(figure, i):
        return float(figure(i)) if callable(figure) else float(figure)

    base = {
        "config_hash": f"{planner}/{robot}/{world}/{people}",
        "code": "",
        "planner": planner.split("_as_")[0],
        "preset": planner,
    }
    base |= {
        "robot": robot,
        "world": world,
        "n_pedestrians": people,
        "simulator": "sim2d",
        "task": "random",
        "pedestrian_model": "s",
    }
    base |= {
        "reaction": "ignore",
        "localizer": "amcl",
        "timing": "ideal",
        "seed": 0,
        "stage": -1,
        "outcome": "goal_reached",
    }
    return [
        {**base, "episode": i, "scenario": f"random/{i:04d}", "scenario_hash": f"{people}"}
        | {
            "collisions": of(collisions, i),
            "success": of(success, i),
            "path_length": of(length, i) + hard[i] + 0.1 * own[i],
        }
        for i in range(n)
    ]


def cells(*groups):
    run = Run(Path("x"), [], {"config": {}})
    return cells_of([Episode(row, run) for group in groups for row in group])


def found(contrast, *groups):
    return contrast_findings(cells(*groups), BY_NAME, [contrast])


def states(contrast, *groups):
    return [one.state for one in found(contrast, *groups)]


LOWER = Contrast("path_length", {"planner": "teb"}, "lower", {"planner": "dwa"})


def test_a_difference_that_pairs_show_holds_and_its_opposite_does_not():
    near = rows("teb", length=9.8), rows("dwa", length=10.0)
    assert states(LOWER, *near) == ["holds"], "0.2 m, where problems differ by 1 m: by pairs alone"
    assert states(Contrast("path_length", {"planner": "dwa"}, "lower", {"planner": "teb"}), *near) == ["does not hold"]
    assert states(LOWER, rows("teb"), rows("dwa", spread=30.0)) == ["cannot be decided"]
    assert states(LOWER, rows("teb")) == ["not tested"]
    assert states(Contrast("jerk", {"planner": "teb"}, "lower", {"planner": "dwa"}), *near) == ["not tested"]


def test_success_averaged_over_planners_is_no_proportion():
    """One of three planners fails in two thirds of the problems: the mean is .22 lower, not
    lower in two thirds of all pairs.
    """
    groups = rows("dwa", success=lambda i: i % 3 == 0), rows("teb"), rows("mpc"), rows("rosnav")
    (one,) = found(Contrast("success", {"planner": ["dwa", "teb", "mpc"]}, "higher", {"planner": "rosnav"}), *groups)
    assert one.estimate.mean == pytest.approx(-2.0 / 9.0)
    assert -1.0 / 3.0 < one.estimate.low < one.estimate.mean < one.estimate.high < 0.0
    (alone,) = found(Contrast("success", {"planner": "dwa"}, "higher", {"planner": "rosnav"}), *groups)
    assert (alone.estimate.method, one.estimate.method) == ("Bonett-Price", "studentised bootstrap")


def test_a_margin_asks_for_more_than_a_difference():
    groups = rows("teb", length=9.8), rows("dwa", length=10.0)
    by = {
        margin: Contrast("path_length", {"planner": "teb"}, "lower", {"planner": "dwa"}, margin=margin)
        for margin in (0.1, 0.5)
    }
    assert states(by[0.1], *groups) == ["holds"]
    (one,) = found(by[0.5], *groups)
    assert one.state == "does not hold"
    assert one.estimate.mean == pytest.approx(-0.2, abs=0.08), "the difference itself, whatever the margin"


@pytest.mark.parametrize(("margin", "state"), [(0.5, "holds"), (0.05, "does not hold")])
def test_what_is_alike_differs_by_less_than_the_margin(margin, state):
    alike = Contrast("path_length", {"planner": "teb"}, "alike", {"planner": "dwa"}, margin=margin)
    assert states(alike, rows("teb", length=9.8), rows("dwa", length=10.0)) == [state]


def test_nobody_is_worse_by_more_than_the_margin():
    not_higher = Contrast("collisions", {"planner": "aio"}, "not_higher", {"planner": "others"}, ["rival"], margin=0.1)
    groups = rows("aio"), rows("dwa", collisions=lambda i: i % 3 == 0), rows("teb")
    assert states(not_higher, *groups) == ["holds", "holds"]
    assert states(
        Contrast("collisions", {"planner": "dwa"}, "not_higher", {"planner": "aio"}, margin=0.1), *groups
    ) == ["does not hold"]


def test_rivals_and_conditions_are_taken_apart():
    groups = [rows(p, world=w, people=n) for p in ("aio", "dwa", "teb") for w in ("a", "b") for n in (5, 10)]
    apart = Contrast(
        "collisions", {"planner": "aio"}, "not_higher", {"planner": "others"}, ["rival", "world", "people"], margin=0.1
    )
    assert len(found(apart, *groups)) == 8
    assert {
        one.what
        for one in found(
            Contrast("success", {"planner": ["dwa", "teb"]}, "at_least", each=["planner"], margin=0.8), *groups
        )
    } == {
        "success of dwa: at least 0.8",
        "success of teb: at least 0.8",
    }


def test_bounds_go_by_the_whole_interval():
    some = rows("teb", collisions=lambda i: i % 10 == 0)
    at_most = {m: Contrast("collisions", {"planner": "teb"}, "at_most", margin=m) for m in (0.01, 0.1, 0.5)}
    assert [states(at_most[m], some)[0] for m in at_most] == ["does not hold", "cannot be decided", "holds"]
    assert states(Contrast("success", {"planner": "teb"}, "at_least", margin=0.8), some) == ["holds"]


def test_path_metrics_are_of_what_both_reached():
    def short_when_lost(i):
        return 10.0 if i % 2 else 1.0

    lost = rows("teb", length=short_when_lost, success=lambda i: i % 2)
    (one,) = found(LOWER, lost, rows("dwa"))
    assert one.estimate.n == 15
    assert abs(one.estimate.mean) < 0.2


def test_more_people_and_who_loses_more_by_them():
    lost = {"gring": lambda i: i % 2, "dwa": lambda i: i % 10 > 0}
    groups = [rows(p, people=n, success=lost[p] if n == 10 else 1.0) for p in lost for n in (5, 10)]
    fewer = Contrast("success", {"people": 10}, "lower", {"people": 5}, ["planner"])
    assert states(fewer, *groups) == ["cannot be decided", "holds"]
    drop = Contrast("success", {"planner": "gring"}, "lower", {"planner": "dwa"}, change={"people": [5, 10]})
    (one,) = found(drop, *groups)
    assert one.state == "holds"
    assert one.estimate.mean == pytest.approx(-0.4, abs=0.01)


def test_planners_that_are_named_together_are_averaged_by_problem():
    groups = rows("aio", collisions=0.0), rows("dwa", collisions=1.0), rows("teb", collisions=lambda i: i % 2)
    (one,) = found(Contrast("collisions", {"planner": "aio"}, "lower", {"planner": ["dwa", "teb"]}), *groups)
    assert one.estimate.mean == pytest.approx(-0.75)
    assert one.estimate.n == 30


def test_a_planner_is_its_preset_or_else_what_goes_by_its_name():
    (one,) = found(LOWER, rows("teb_as_released", length=8.0), rows("dwa", length=10.0))
    assert one.state == "holds"
    (one,) = found(LOWER, rows("teb_as_released", length=8.0), rows("teb", length=12.0), rows("dwa", length=10.0))
    assert one.state == "does not hold"


def test_verdicts_follow_from_the_contrasts():
    groups = cells(rows("teb", length=9.0), rows("dwa", length=10.0))
    true, false = LOWER, Contrast("path_length", {"planner": "dwa"}, "lower", {"planner": "teb"})
    open_one = Contrast("success", {"planner": "teb"}, "lower", {"planner": "dwa"})
    missing = Contrast("path_length", {"planner": "mpc"}, "lower", {"planner": "teb"})
    cases = {
        "a": [true],
        "b": [true, false, missing],
        "c": [true, open_one],
        "d": [true, open_one, missing],
    }
    claims = Claims("somebody", {name: Claim(f"says {name}", contrasts) for name, contrasts in cases.items()})
    judged = judge_claims(groups, COLUMNS, claims)
    assert [one.verdict for one in judged] == ["reproduced", "not reproduced", "cannot be decided", "not tested"]
    table = claims_table(judged, "somebody")
    assert table.rows[2][1] == "cannot be decided (no difference is seen)"
    assert "lower than teb" in table.rows[1][2]
    assert all(len(row) == len(table.head) for row in table.rows)


def test_chance_is_seldom_taken_for_a_claim_that_holds():
    """Of claims of three contrasts where nothing differs, next to none are reproduced, and next to none refuted."""
    random = np.random.default_rng(3)
    verdicts = []
    for _ in range(20):
        noise = {name: random.normal(10.0, 1.0, 20) for name in ("teb", "dwa", "mpc", "aio")}
        groups = cells(*(rows(name, n=20, length=lambda i, of=of: of[i]) for name, of in noise.items()))
        claim = Claim("", [Contrast("path_length", {"planner": "aio"}, "lower", {"planner": "others"}, ["rival"])])
        verdicts.append(judge_claims(groups, COLUMNS, Claims("", {"1": claim}))[0].verdict)
    assert verdicts.count("reproduced") == 0
    assert verdicts.count("not reproduced") <= 3


def test_the_papers_claims_can_be_read():
    claims = read_claims("paper")
    assert list(claims.claims) == [str(number) for number in range(1, 23)]
    assert all(claim.says.endswith(".") and claim.contrasts for claim in claims.claims.values())


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[1]", r"holds no mapping; allowed: a file of claims"),
        ("source: x\nclaims: {1: {says: y}}", r"claims\.1 lacks contrasts"),
        ("source: x\nclaims: {}\nnote: 1", r"has no parameter note"),
        (
            "source: x\nclaims: {1: {says: y, contrasts: [{metric: a, of: {}, expected: less, than: {}}]}}",
            r"expected is 'less'; allowed: one of lower",
        ),
        (
            "source: x\nclaims: {1: {says: y, contrasts: [{metric: a, of: {}, expected: lower}]}}",
            r"expected is lower; allowed: at_most or",
        ),
        (
            "source: x\nclaims: {1: {says: y, contrasts: [{metric: a, of: {}, expected: at_most, change: "
            "{people: [5]}}]}}",
            r"change is wrong; allowed: one factor with two values",
        ),
    ],
)
def test_a_wrong_file_of_claims_is_refused_in_one_line(tmp_path, text, message):
    (tmp_path / "mine.yaml").write_text(text)
    with pytest.raises(ConfigurationError, match=rf"mine\.yaml: .*{message}"):
        read_claims(str(tmp_path / "mine.yaml"))


def test_an_unknown_name_is_refused():
    with pytest.raises(ConfigurationError, match=r"claims is nothing; allowed: .*paper.* or a file"):
        read_claims("nothing")


def test_the_report_says_which_claims_hold(run_folder, tmp_path, capsys):
    run_folder(tmp_path / "dwa", planner="dwa", episodes=12, fails=range(1, 11), only=("success", "collisions"))
    run_folder(tmp_path / "teb", planner="teb", episodes=12, fails=[1], only=("success", "collisions"))
    (tmp_path / "mine.yaml").write_text(
        "source: us\nclaims:\n  1:\n    says: TEB arrives.\n"
        "    contrasts: [{metric: success, of: {planner: teb}, than: {planner: dwa}, expected: higher}]\n"
    )
    assert (
        ReportCommand().run(
            [str(tmp_path), "--out", str(tmp_path / "r"), "--no-figures", "--claims", str(tmp_path / "mine.yaml")]
        )
        == 0
    )
    assert "reproduced: 1. TEB arrives." in capsys.readouterr().out
    assert "Claims of us" in (tmp_path / "r" / "index.html").read_text()
    assert "reproduced" in (tmp_path / "r" / "tables" / "claims.csv").read_text()
