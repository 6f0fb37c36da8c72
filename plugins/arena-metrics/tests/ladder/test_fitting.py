"""The psychometric fit against brute force, its gradient against differences, and its ends."""

import math

import numpy as np
import pytest
from scipy.optimize import check_grad

from arena_ladder import fitting
from arena_ladder.fitting import PRIOR, Counts, Fit, breaking_slope, covariance, fit_counts, posterior_draws

RUNGS = np.array([0.0, 1.0, 2.0, 4.0, 8.0, 12.0, 16.0, 24.0])


def expected(slope, halves, lapses, episodes=1e5):
    """Return counts that are exactly what a planner's curve says."""
    fit = Fit(np.concatenate(([math.log(slope), 2.0], np.log(halves), np.log(lapses) - np.log1p(-np.array(lapses)))))
    chances = np.array([fit.success(cell, RUNGS) for cell in range(len(halves))])
    shape = (len(halves), len(RUNGS))
    return Counts(np.tile(RUNGS, (len(halves), 1)), np.full(shape, episodes), episodes * chances)


def one_cell(successes, episodes):
    return Counts(RUNGS[None], np.array([episodes], dtype=float), np.array([successes], dtype=float))


def test_many_episodes_give_back_the_curve_that_they_were_drawn_from():
    found = fit_counts(expected(2.5, [4.0, 9.0], [0.02, 0.05]))
    assert found.slope == pytest.approx(2.5, rel=0.01)
    assert found.halves == pytest.approx([4.0, 9.0], rel=0.01)
    assert found.lapses == pytest.approx([0.02, 0.05], abs=0.002)


def test_breaking_density_is_where_success_itself_comes_down_to_the_share():
    """Closed form: half (r / (1 - lapse) ...) of the logistic; what fails without people counts."""
    found = fit_counts(expected(2.0, [8.0], [0.05]))
    at = math.exp(found.log_breaking(0.9)[0])
    assert found.success(0, np.array([at]))[0] == pytest.approx(0.9)
    assert at == pytest.approx(8.0 * ((0.95 / 0.9) - 1.0) ** 0.5, rel=0.05)


def test_planner_that_fails_a_fifth_without_people_never_has_nine_tenths():
    found = fit_counts(expected(2.0, [8.0], [0.2]))
    assert found.log_breaking(0.9)[0] == -math.inf
    assert math.isfinite(found.log_breaking(0.5)[0])


def test_gradient_is_that_of_the_loss():
    counts = expected(2.0, [3.0, 10.0], [0.03, 0.01], episodes=12.0)
    theta = np.random.default_rng(1).normal([0.5, 2.0, 1.0, 2.0, -3.0, -4.0], 0.3)
    off = check_grad(
        lambda x: fitting._loss_and_slope(x, counts, PRIOR)[0],
        lambda x: fitting._loss_and_slope(x, counts, PRIOR)[1],
        theta,
    )
    assert off < 1e-4


def test_posterior_of_one_cell_is_that_of_a_grid():
    """Mean and deviation of the log breaking density by brute force over slope, half and lapse."""
    counts = one_cell([40, 38, 39, 36, 25, 16, 9, 4], [40] * 8)
    fit = fit_counts(counts)
    slopes, halves, logits = np.meshgrid(
        np.linspace(-0.4, 1.8, 50), np.linspace(1.5, 3.0, 60), np.linspace(-7.0, -1.0, 50), indexing="ij"
    )
    lapses = 1.0 / (1.0 + np.exp(-logits))
    log = -0.5 * ((slopes - PRIOR.slope[0]) / PRIOR.slope[1]) ** 2
    wide = math.hypot(PRIOR.middle[1], PRIOR.spread)  # the middle of all cells integrated out
    log += -0.5 * ((halves - PRIOR.middle[0]) / wide) ** 2
    log += PRIOR.lapse[0] * np.log(lapses) + PRIOR.lapse[1] * np.log1p(-lapses)
    for x, n, k in zip(RUNGS, counts.episodes[0], counts.successes[0], strict=True):
        p = (1.0 - lapses) / (1.0 + (np.exp(np.exp(slopes) * (math.log(x) - halves)) if x else 0.0))
        log += k * np.log(p) + (n - k) * np.log1p(-p)
    weights = np.exp(log - log.max())
    r = 0.5 / (1.0 - lapses)
    breaking = halves + np.log((1.0 - r) / r) / np.exp(slopes)
    mean = (weights * breaking).sum() / weights.sum()
    deviation = math.sqrt((weights * (breaking - mean) ** 2).sum() / weights.sum())
    along = breaking_slope(fit, 0, 0.5)
    assert fit.log_breaking(0.5)[0] == pytest.approx(mean, abs=0.3 * deviation)
    assert math.sqrt(along @ covariance(fit, counts) @ along) == pytest.approx(deviation, rel=0.15)


def test_cell_without_episodes_lies_where_the_others_do():
    counts = expected(2.0, [6.0, 6.0], [0.02, 0.02])
    empty = Counts(counts.densities, counts.episodes * [[1.0], [0.0]], counts.successes * [[1.0], [0.0]])
    assert fit_counts(empty).halves[1] == pytest.approx(6.0, rel=0.15)


def test_losses_of_many_parameters_are_those_of_each():
    counts = one_cell([8, 0, 0, 7, 0, 3, 0, 0], [8, 0, 0, 8, 0, 8, 0, 0])
    fit = fit_counts(counts)
    thetas = fit.theta + np.random.default_rng(3).normal(0.0, 0.5, (6, len(fit.theta)))
    alone = [fitting._loss_and_slope(theta, counts, PRIOR)[0] for theta in thetas]
    np.testing.assert_allclose(fitting._losses(thetas, counts, PRIOR), alone, rtol=1e-12)


def test_draws_of_a_lapse_alone_are_its_beta_distribution():
    """Without people successes tell of the lapse only: of Beta(1, 15) and 24 successes Beta(1, 39) is left."""
    counts = one_cell([24, 0, 0, 0, 0, 0, 0, 0], [24, 0, 0, 0, 0, 0, 0, 0])
    drawn = posterior_draws(fit_counts(counts), counts, 400, np.random.default_rng(5))
    lapses = [Fit(theta).lapses[0] for theta in drawn]
    wanted = 1.0 - (1.0 - np.array([0.1, 0.5, 0.975])) ** (1.0 / 39.0)
    np.testing.assert_allclose(np.quantile(lapses, (0.1, 0.5, 0.975)), wanted, rtol=0.2)
