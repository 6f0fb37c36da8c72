"""How predictions are scored: figures by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from arena_core import Predictions
from arena_prediction.scores import (
    SUREST,
    alternatives_at,
    covariances_at,
    join_scores,
    score_predictions,
    summarise,
)

TIMES = np.array((1.0, 2.0))


def straight(velocity=(1.0, 0.0), variance=0.04):
    covariance = np.diag((variance, variance, 0.0, 0.0))[None]
    return Predictions.straight(np.zeros((1, 2)), np.array([velocity]), covariance)


def two_ways():
    """Return one track that goes straight with .7, or to the left with .3."""
    times = np.array((0.0, 1.0, 2.0))
    ahead = np.array(((0.0, 0.0), (1.0, 0.0), (2.0, 0.0)))
    left = np.array(((0.0, 0.0), (0.0, 1.0), (0.0, 2.0)))
    several = np.stack((ahead, left))[:, None], np.array(((0.7,), (0.3,)))
    return Predictions.of(times, ahead[None], np.tile(0.09 * np.eye(2), (1, 3, 1, 1)), None, several)


def test_errors_are_means_over_times_and_those_at_the_last_one():
    truth = np.array((((1.0, 0.3), (2.0, 0.4)),))
    found = summarise(score_predictions(straight(), TIMES, truth), 0.5)
    assert (found.ade, found.fde, found.min_ade, found.min_fde, found.missed) == pytest.approx(
        (0.35, 0.4, 0.35, 0.4, 0)
    )


def test_the_best_hypothesis_is_the_best_on_the_whole():
    truth = np.array((((0.0, 1.0), (0.0, 1.9)),))
    scores = score_predictions(two_ways(), TIMES, truth)
    found = summarise(scores, 0.5)
    assert found.ade == pytest.approx((math.hypot(1, 1) + math.hypot(2, 1.9)) / 2)
    assert found.min_ade == pytest.approx(0.05)
    assert found.min_fde == pytest.approx(0.1)
    assert found.missed == 0.0
    assert summarise(scores, 0.09).missed == 1.0


def test_the_most_probable_way_counts_among_the_hypotheses():
    truth = np.array((((1.0, 0.0), (2.0, 0.0)),))
    assert summarise(score_predictions(straight(), TIMES, truth), 0.5).min_ade == 0.0


def test_likelihood_is_that_of_a_gaussian_with_the_least_deviation_added():
    variance = 0.04 + SUREST**2
    truth = np.array((((1.0, 0.3), (2.0, 0.0)),))
    found = summarise(score_predictions(straight(), TIMES, truth), 0.5)
    at_the_mean = math.log(2 * math.pi * variance)
    assert found.nll == pytest.approx(at_the_mean + 0.5 * (0.5 * 0.3**2 / variance))


def test_a_sure_predictor_without_variance_has_a_finite_likelihood():
    found = summarise(score_predictions(straight(variance=0.0), TIMES, np.array((((1.0, 0.0), (2.0, 0.0)),))), 0.5)
    assert found.nll == pytest.approx(math.log(2 * math.pi * SUREST**2))


def test_errors_as_wide_as_they_are_expected_lie_within_the_ellipses_as_often():
    rng, count = np.random.default_rng(3), 20_000
    covariance = np.array(((0.5, 0.3), (0.3, 0.4)))
    spread = np.zeros((count, 4, 4))
    spread[:, :2, :2] = covariance - SUREST**2 * np.eye(2)
    said = Predictions.straight(np.zeros((count, 2)), np.zeros((count, 2)), spread)
    truth = rng.multivariate_normal((0.0, 0.0), covariance, (count, 1))
    found = summarise(score_predictions(said, np.array((1.0,)), truth), 0.5)
    assert (found.in_50, found.in_90) == pytest.approx((0.5, 0.9), abs=0.01)


def test_alternatives_go_on_after_the_last_time_as_they_went():
    ways = alternatives_at(two_ways(), np.array((0.5, 3.0)))
    np.testing.assert_allclose(ways[1, 0], ((0.0, 0.5), (0.0, 3.0)))


def test_covariances_grow_with_the_doubt_of_the_velocity():
    covariance = np.diag((0.04, 0.04, 0.01, 0.01))[None]
    said = Predictions.straight(np.zeros((1, 2)), np.zeros((1, 2)), covariance)
    np.testing.assert_allclose(covariances_at(said, TIMES)[0, :, 0, 0], (0.05, 0.08))
    np.testing.assert_allclose(np.sqrt(covariances_at(said, TIMES)[..., 0, 0]), said.deviations(TIMES))


def test_scores_of_parts_are_those_of_all_together():
    truth = np.array((((1.0, 0.3), (2.0, 0.4)),))
    one = score_predictions(straight(), TIMES, truth)
    assert summarise(join_scores([one, one]), 0.5).tracks == 2
