"""Each kind of comparison in pairs against its published formula or against counting all cases."""

import math
from itertools import pairwise, product

import numpy as np
import pytest
from scipy.stats import multinomial, norm, t, ttest_1samp

from arena_core.statistics import compare, make_clusters
from arena_core.statistics.clusters import resample_counts
from arena_core.statistics.intervals import design_effect

STEPS = np.array([0.9, 1.4, -0.2, 0.8, 2.5, 0.1, 0.7])
MANY = np.random.default_rng(1).normal(0.2, 1.0, 250)


def against_nothing(values, kind="figure", **labels):
    return compare(values, np.zeros(len(values)), kind, **labels)


def test_p_of_figures_is_the_greater_of_students_and_the_bootstraps():
    found, mean = against_nothing(STEPS), STEPS.mean()
    error = STEPS.std(ddof=1) / math.sqrt(7)
    again = np.array([np.repeat(STEPS, row) for row in resample_counts((7,)).astype(int)])
    pivots = (again.mean(axis=1) - mean) / np.maximum(again.std(axis=1, ddof=1) / math.sqrt(7), 0.35 * error)
    resampled = 2.0 * ((pivots >= mean / error).sum() + 1) / 5001
    assert found.p == pytest.approx(max(ttest_1samp(STEPS, 0.0).pvalue, resampled))
    mirrored = against_nothing(-STEPS)
    assert mirrored.p == pytest.approx(max(ttest_1samp(STEPS, 0.0).pvalue, resampled))


def test_more_comparisons_than_resamples_can_tell_still_find_a_clear_difference():
    """Beyond all 5000 resamples p is no constant: a difference may be clear among a thousand comparisons."""
    clear, clearer = (against_nothing(np.random.default_rng(2).gamma(2.0, 1.0, 30) + shift).p for shift in (1.0, 3.0))
    assert clearer < clear < 0.05 / 1000
    student = ttest_1samp(np.random.default_rng(2).gamma(2.0, 1.0, 30) + 3.0, 0.0).pvalue
    assert clearer >= student


def test_p_beyond_the_resamples_goes_on_where_they_end():
    values = np.random.default_rng(3).gamma(2.0, 1.0, 20) - 2.0
    shown = [against_nothing(values + shift).p for shift in np.linspace(0.0, 3.0, 40)]
    assert all(later <= earlier + 1e-12 for earlier, later in pairwise(shown))
    assert shown[-1] < 2 / 5001


def test_smallest_effect_is_the_one_that_takes_no_more_pairs():
    for pairs in (np.array([1.0] * 6 + [-1.0] * 6 + [0.0] * 48), np.zeros(40), np.ones(9)):
        found, decided = against_nothing(pairs, True), (np.abs(pairs).sum() + 1.0) / (len(pairs) + 2.0)
        d, share = found.smallest, max(decided, found.smallest)
        z = norm.ppf(0.975) * math.sqrt(share) + norm.ppf(0.8) * math.sqrt(share - d**2)
        assert (z / d) ** 2 == pytest.approx(len(pairs), rel=0.03)
    figures = against_nothing(STEPS)
    assert figures.smallest == pytest.approx((t.ppf(0.975, 6) + norm.ppf(0.8)) * STEPS.std(ddof=1) / math.sqrt(7))


def coverage_of_all_tables(n, won, lost):
    """Return how often the interval of n pairs holds won - lost, and how often p is .05 or less, over all tables."""
    held = told = 0.0
    for a in range(n + 1):
        for b in range(n + 1 - a):
            chance = multinomial.pmf((a, b, n - a - b), n, (won, lost, 1.0 - won - lost))
            if chance > 1e-7:
                found = against_nothing(np.repeat([1.0, -1.0, 0.0], (a, b, n - a - b)), True)
                held += chance * (found.difference.low - 1e-12 <= won - lost <= found.difference.high + 1e-12)
                told += chance * (found.p <= 0.05)
    return held, told


def test_intervals_of_paired_proportions_hold_the_difference_in_95_percent_of_all_tables():
    """Summed, not drawn: 30 pairs of which 12 to 18 differ."""
    equal = [coverage_of_all_tables(30, share / 2, share / 2) for share in (0.4, 0.6)]
    apart = [coverage_of_all_tables(30, 0.3, 0.1), coverage_of_all_tables(30, 0.4, 0.2)]
    assert all(0.93 <= held <= 0.97 for held, _ in (*equal, *apart))
    assert all(0.03 <= told <= 0.05 for _, told in equal)


def test_intervals_of_few_differing_pairs_hold_the_difference_too():
    assert coverage_of_all_tables(15, 0.1, 0.1)[0] >= 0.93


def test_p_of_many_figures_is_students():
    assert against_nothing(MANY).p == pytest.approx(ttest_1samp(MANY, 0.0).pvalue)


def test_p_without_scatter_is_that_of_flipping_every_sign():
    assert against_nothing(np.full(6, 2.5)).p == 2.0 ** (1 - 6)
    assert against_nothing(np.zeros(6)).p == 1.0
    assert math.isnan(against_nothing(np.full(6, 2.5)).effect)


def test_counts_have_one_more_event_on_each_side_that_no_one_saw():
    """Two events in n problems are root 2 over n of error beside the sample's own."""
    counts = np.round(MANY)
    error = math.hypot(counts.std(ddof=1) / math.sqrt(250), math.sqrt(2.0) / 250)
    found, half = against_nothing(counts, "count"), t.ppf(0.975, 249) * error
    assert found.p == pytest.approx(2.0 * t.cdf(-abs(counts.mean()) / error, 249))
    assert found.difference.low == pytest.approx(counts.mean() - half)
    assert found.difference.high == pytest.approx(counts.mean() + half)


def test_counts_that_are_all_alike_are_not_certain():
    found = against_nothing(np.ones(9), "count")
    assert found.difference.high - 1.0 == pytest.approx(t.ppf(0.975, 8) * math.sqrt(2.0) / 9)
    assert found.p == pytest.approx(2.0 * t.cdf(-9 / math.sqrt(2.0), 8))


def test_effect_of_figures_is_the_mean_over_the_standard_deviation():
    assert against_nothing(STEPS).effect == pytest.approx(STEPS.mean() / STEPS.std(ddof=1))


def test_effect_of_proportions_is_the_share_of_decided_pairs_won_less_a_half():
    found = against_nothing(np.array([1.0, 1.0, 1.0, -1.0, 0.0, 0.0]), True)
    assert (found.effect, found.higher, found.lower) == (0.25, 3, 1)
    assert against_nothing(np.zeros(6), True).effect == 0.0


REPEATS = np.array([1.0, 1.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0])
PROBLEMS = [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]


def test_p_of_repeated_proportions_is_that_of_flipping_whole_problems():
    sums = REPEATS.reshape(6, 2).sum(axis=1)
    flipped = np.abs([np.dot(signs, sums) for signs in product((-1.0, 1.0), repeat=6)])
    beyond, alike = np.mean(flipped > abs(sums.sum())), np.mean(flipped == abs(sums.sum()))
    assert against_nothing(REPEATS, True, problems=PROBLEMS).p == pytest.approx(beyond + alike / 2)


def test_interval_of_repeated_proportions_counts_that_many_independent_pairs():
    found, sample = against_nothing(-REPEATS, True, problems=PROBLEMS), make_clusters(REPEATS, PROBLEMS, None)
    share, z = 1.0 / design_effect(REPEATS, sample), t.ppf(0.975, 5)
    n = 12.0 * share + 2.0
    won, lost = (1.0 * share + 1.0) / n, (6.0 * share + 1.0) / n
    half = z * math.sqrt((won + lost - (won - lost) ** 2) / n)
    assert found.p > 0.05
    assert found.difference.low == pytest.approx(max(-1.0, won - lost - half))
    assert found.difference.high == pytest.approx(max(won - lost + half, 0.0)), "as far as 0, which p does not exclude"
    assert (found.higher, found.lower, found.unit) == (1, 6, "problems")


def test_proportions_differ_by_1_at_most():
    found = against_nothing(np.ones(30), True).difference
    assert (found.mean, found.high) == (1.0, 1.0)
    assert 0.8 < found.low < 1.0
    assert against_nothing(-np.ones(30), True).difference.low == -1.0


def test_how_many_more_problems_would_show_a_tenth_follows_from_the_design_effect():
    """Miettinen 1968: quantiles of 5 % false alarms and 80 % power; Laplace's estimate of how many pairs differ."""
    found, sample = against_nothing(REPEATS, True, problems=PROBLEMS), make_clusters(REPEATS, PROBLEMS, None)
    decided = (7.0 + 1.0) / (12.0 + 2.0)
    z = norm.ppf(0.975) * math.sqrt(decided) + norm.ppf(0.8) * math.sqrt(decided - 0.01)
    needed = design_effect(REPEATS, sample) * (z / 0.1) ** 2
    assert found.more == pytest.approx((needed / 12.0 - 1.0) * 6.0)


def test_where_next_to_no_pair_differs_a_tenth_of_them_is_taken_to():
    found = against_nothing(np.zeros(40), True)
    z = norm.ppf(0.975) * math.sqrt(0.1) + norm.ppf(0.8) * math.sqrt(0.1 - 0.01)
    assert found.more == pytest.approx((z / 0.1) ** 2 - 40.0)
    assert found.unit == "episodes"


@pytest.mark.parametrize(("n", "tested"), [(4, False), (5, True)])
def test_a_test_takes_five_problems(n, tested):
    assert math.isfinite(against_nothing(np.arange(1.0, n + 1.0)).p) == tested


def test_few_pairs_still_have_their_mean_and_none_has_not():
    few, none = against_nothing([1.0, 4.0]), against_nothing([math.nan])
    assert (few.difference.mean, few.difference.n, few.difference.problems, few.higher) == (2.5, 2, 2, 2)
    assert math.isnan(none.difference.mean)
    assert none.difference.n == 0
