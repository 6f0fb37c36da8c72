"""Differences between planners on the same scenarios."""

import math

import numpy as np
import pytest
from scipy.stats import binom
from statsmodels.stats.contingency_tables import mcnemar
from statsmodels.stats.multitest import multipletests

from arena_core import InputFileError
from arena_core.statistics import after_holm, compare, estimate, estimate_difference
from arena_metrics.pages.report import ReportCommand
from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.runs import metric_columns, pool_episodes, read_runs
from arena_metrics.pooling.summary import summarise_cells
from arena_metrics.tables.pairs import comparison_rows, p_text, paired_tables

FEW = ("success", "collisions", "path_length")


def tables_of(folder, baseline=None):
    runs = read_runs([folder])
    tables = paired_tables(summarise_cells(cells_of(pool_episodes(runs)[0]), metric_columns(runs)), baseline)
    return {table.caption.partition(",")[0].partition(" [")[0]: table for table in tables}


def test_pairs_find_a_difference_that_is_smaller_than_the_scatter():
    random = np.random.default_rng(0)
    luck = random.normal(0.0, 10.0, 30)
    ours, theirs = luck + 1.0 + random.normal(0.0, 0.5, 30), luck
    paired, first, second = estimate_difference(ours, theirs), estimate(ours), estimate(theirs)
    assert paired.low > 0.0
    assert first.low < second.high


def test_pair_counts_only_where_both_are_defined():
    assert estimate_difference([1.0, np.nan, 3.0, 5.0], [0.0, 1.0, np.nan, 2.0]).n == 2


def wins(won, lost, alike):
    """Return successes of two planners that differ in so many pairs."""
    return np.array([1.0] * won + [0.0] * lost + [1.0] * alike), np.array([0.0] * won + [1.0] * lost + [1.0] * alike)


def test_interval_of_paired_proportions_is_that_of_bonett_and_price():
    found = estimate_difference(*wins(12, 2, 16), proportion=True)
    won, lost, n = 13 / 32, 3 / 32, 32
    half = 1.959964 * math.sqrt((won + lost - (won - lost) ** 2) / n)
    assert found.mean == pytest.approx(1 / 3)
    assert (found.low, found.high) == pytest.approx((won - lost - half, won - lost + half), abs=1e-6)


def test_equal_proportions_are_not_certain_to_be_equal():
    found = estimate_difference(np.ones(30), np.ones(30), proportion=True)
    assert found.mean == 0.0
    assert found.low < 0.0 < found.high


def test_p_of_success_is_mcnemars_mid_p():
    """Of what was seen itself half counts."""
    assert compare(*wins(6, 0, 9), True).p == pytest.approx(2 * 0.5 * 0.5**6)
    assert compare(*wins(7, 2, 30), True).p == pytest.approx(2 * (1 + 9 + 36 / 2) / 2**9)
    assert compare(*wins(4, 4, 9), True).p == 1.0
    assert compare(*wins(0, 0, 15), True).p == 1.0


@pytest.mark.parametrize(("won", "lost", "alike"), [(6, 0, 9), (5, 0, 5), (7, 2, 30), (3, 3, 9), (0, 0, 8), (5, 1, 4)])
def test_flipping_signs_by_problem_is_mcnemars_test_where_nothing_is_repeated(won, lost, alike):
    ours, theirs = wins(won, lost, alike)
    # one more pair, that says nothing
    repeated = compare(np.append(ours, 1.0), np.append(theirs, 1.0), True, [*range(len(ours)), 0])
    assert repeated.p == pytest.approx(compare(ours, theirs, True).p)


@pytest.mark.parametrize("lost", range(6))
def test_interval_and_exact_test_say_the_same(lost):
    for won in range(16 - lost):
        found = compare(*wins(won, lost, 15 - won - lost), True)
        assert (found.p > 0.05) == (found.difference.low <= 0.0 <= found.difference.high)


def test_repeats_of_a_problem_do_not_make_a_difference_surer():
    ours, theirs = wins(4, 1, 3)
    once = compare(ours, theirs, True)
    often = compare(np.repeat(ours, 20), np.repeat(theirs, 20), True, [i for i in range(8) for _ in range(20)])
    assert often.p == pytest.approx(once.p)
    assert often.difference.high - often.difference.low >= 0.95 * (once.difference.high - once.difference.low)
    assert often.difference.problems == 8
    assert compare(np.repeat(ours, 20), np.repeat(theirs, 20), True).p < 1e-6  # so it would look without the problems


def test_figures_are_no_surer_for_repeats_either():
    random = np.random.default_rng(4)
    steps = random.normal(0.4, 1.0, 8)
    once, often = (
        compare(steps, np.zeros(8)),
        compare(np.repeat(steps, 9), np.zeros(72), "figure", [i for i in range(8) for _ in range(9)]),
    )
    assert (often.p, often.difference.low, often.difference.high) == pytest.approx(
        (once.p, once.difference.low, once.difference.high)
    )


def test_fewer_than_five_problems_say_nothing_of_others():
    found = compare(np.ones(40), np.zeros(40), True, [i // 10 for i in range(40)])
    assert (found.difference.mean, found.difference.problems, found.difference.has_interval) == (1.0, 4, False)
    assert math.isnan(found.p)
    assert not found.told_apart


def test_holm_multiplies_the_least_p_by_the_number_of_comparisons():
    family = [compare(*wins(won, 0, 20), True) for won in (8, 6, 2)]
    few = compare(np.ones(3), np.zeros(3), True)
    adjusted = after_holm([*family, few])
    assert [one.holm for one in adjusted[:3]] == pytest.approx([3 / 2**8, 2 / 2**6, 0.25])
    assert [one.told_apart for one in adjusted] == [True, True, False, False]
    assert adjusted[3] is few


def mid_p(higher, lower):
    """Return the exact p of statsmodels less the chance of what was seen."""
    exact = mcnemar([[0, higher], [lower, 0]]).pvalue if higher + lower else 1.0
    return 1.0 if higher == lower else exact - binom.pmf(higher, higher + lower, 0.5)


@pytest.mark.slow
def test_p_is_that_of_statsmodels():
    random = np.random.default_rng(7)
    for size in (1, 2, 3, 5, 9, 39):
        family = [compare(*wins(*random.integers(0, 9, 2), 6), True) for _ in range(size)]
        told = [mid_p(one.higher, one.lower) for one in family]
        assert [one.p for one in family] == pytest.approx(told)
        assert [one.holm for one in after_holm(family)] == pytest.approx(multipletests(told, method="holm")[1])


def test_effect_is_cohens():
    assert compare(*wins(6, 2, 4), True).effect == pytest.approx(0.25)
    assert compare([1.0, 2.0, 3.0, 4.0, 5.0], np.zeros(5)).effect == pytest.approx(
        3.0 / np.std([1, 2, 3, 4, 5], ddof=1)
    )


def test_how_many_more_episodes_would_tell_follows_from_how_many_pairs_differ():
    few, many = compare(*wins(2, 2, 16), True), compare(*wins(8, 8, 4), True)
    assert 0.0 < few.more < many.more
    z = 1.959964 * math.sqrt(5 / 22) + 0.841621 * math.sqrt(5 / 22 - 0.01)
    assert few.more == pytest.approx((z / 0.1) ** 2 - 20, abs=1e-3)
    assert compare(*wins(15, 15, 970), True).more == 0.0


@pytest.mark.parametrize(
    ("p", "text"), [(0.0004, "< .001"), (0.0042, ".004"), (0.031, ".031"), (0.62, ".62"), (0.999, "1"), (math.nan, "–")]
)
def test_p_is_written_short(p, text):
    assert p_text(p) == text


def test_difference_from_itself_has_the_opposite_sign_of_its_mirror():
    ours, theirs = np.random.default_rng(1).normal(size=(2, 20))
    one, other = estimate_difference(ours, theirs), estimate_difference(theirs, ours)
    assert (one.mean, one.low) == pytest.approx((-other.mean, -other.high), abs=0.02)


def test_every_other_planner_is_compared_under_its_own_condition(run_folder, tmp_path):
    for planner in ("dwa", "mpc", "teb"):
        for people in (5, 10):
            run_folder(tmp_path / f"{planner}{people}", planner=planner, people=people, episodes=6)
    table = tables_of(tmp_path)["success"]
    assert [row[:2] for row in table.rows] == [[f"{n} people", f"{p} − dwa"] for n in (5, 10) for p in ("mpc", "teb")]
    assert dict(zip(table.head, table.rows[0], strict=True)) | {"p": ".."} == {
        **{
            "condition": "5 people",
            "difference": "mpc − dwa",
            "mean [95 % interval]": "+0 [−35, +35]",
            "p": "..",
            "p after Holm": "1",
        },
        **{"effect": "+0.00", "higher / lower": "0 / 0", "pairs": "6", "problems": "6"},
    }
    assert [row[1] for row in tables_of(tmp_path, "teb")["success"].rows[:2]] == ["dwa − teb", "mpc − teb"]


def test_scenarios_that_only_one_drove_are_no_pairs(run_folder, tmp_path):
    run_folder(tmp_path / "a", planner="dwa", episodes=6)
    run_folder(tmp_path / "b", planner="teb", episodes=4, errors=(1,))
    tables = tables_of(tmp_path)
    assert tables["success"].rows[0][-2:] == ["3", "3"]
    assert tables["success"].rows[0][1:3] == ["+0", "–"]  # too few for an interval
    assert tables["path length"].rows[0][-2:] == ["2", "2"]


def test_path_time_and_smoothness_pair_what_both_succeeded_in_and_success_pairs_all(run_folder, tmp_path):
    for planner in ("dwa", "teb"):
        run_folder(tmp_path / planner, planner=planner, episodes=8)
    captions = {name: table.caption for name, table in tables_of(tmp_path).items()}
    both = {name for name, caption in captions.items() if caption.endswith("pairs of episodes in which both succeeded")}
    assert both == {"time to goal", "path length", "jerk"}
    assert all(caption.endswith("pairs of all episodes") for name, caption in captions.items() if name not in both)
    assert tables_of(tmp_path)["path length"].rows[0][-2:] == ["4", "4"]


def test_staged_episodes_are_no_pairs(run_folder, tmp_path):
    for planner in ("dwa", "teb"):
        run_folder(tmp_path / planner, planner=planner, stages=(0, 0, 1))
    assert tables_of(tmp_path) == {}


def test_without_a_rival_there_is_no_table(run_folder, tmp_path):
    assert tables_of(run_folder(tmp_path / "a")) == {}


def test_report_holds_the_pairs_and_refuses_an_unknown_baseline(run_folder, tmp_path):
    for planner in ("dwa", "teb"):
        run_folder(tmp_path / planner, planner=planner, only=FEW)
    assert (
        ReportCommand().run([str(tmp_path), "--out", str(tmp_path / "out"), "--no-figures", "--baseline", "teb"]) == 0
    )
    assert "dwa − teb" in (tmp_path / "out" / "tables" / "paired_differences.md").read_text()
    assert "Differences in pairs" in (tmp_path / "out" / "index.html").read_text()
    with pytest.raises(InputFileError, match="allowed: dwa, teb"):
        ReportCommand().run([str(tmp_path), "--out", str(tmp_path / "out"), "--baseline", "mpc"])


def test_comparisons_in_python_and_in_the_studio_have_the_words_of_the_report(run_folder, tmp_path):
    for planner in ("dwa", "teb", "mpc"):
        run_folder(tmp_path / planner, planner=planner, episodes=8)
    runs = read_runs([tmp_path])
    lines = {
        (one["title"], one["planner"]): one
        for one in comparison_rows(cells_of(pool_episodes(runs)[0]), metric_columns(runs))
    }
    for table in tables_of(tmp_path).values():
        for row in table.rows:
            said = dict(zip(table.head, row, strict=True))
            one = lines[table.caption.rpartition(", pairs of ")[0], said["difference"].split(" − ")[0]]
            assert (one["shown"], one["p_shown"], one["p_holm_shown"]) == (
                said["mean [95 % interval]"],
                said["p"],
                said["p after Holm"],
            )
            assert table.caption == f"{one['title']}, pairs of {one['over_shown']}"
