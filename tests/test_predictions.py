"""Predictions: places between and beyond their times; what a predictor may not say; who asks for them."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import NO_TRACKS, Predictions, Predictor
from arena_core.base.errors import ContractViolation, InvalidPredictions
from arena_core.hosting import foresee, straight_predictions
from arena_core.testing import check, component, robot, tracked, view

WALKS = tracked((1.0, 2.0, 0.5, 0.0), (0.0, 0.0, 0.0, -1.0), variance=0.04)
TIMES = np.array((0.0, 1.0, 2.0))
BENT = np.array((((1.0, 2.0), (1.5, 2.0), (1.5, 2.5)), ((0.0, 0.0), (0.0, -1.0), (1.0, -1.0))))


def bent(**changes):
    covariances = np.tile(np.array((0.04, 0.09, 0.16))[:, None, None] * np.eye(2), (2, 1, 1, 1))
    return replace(Predictions.of(TIMES, BENT, covariances), **changes)


class Says(Predictor):
    def __init__(self, answer):
        self.answer = answer

    def reset(self, grid):
        pass

    def predict(self, observation):
        return self.answer


def test_straight_predictions_are_the_very_numbers_of_a_straight_line():
    times = np.array((0.1, 0.7, 3.3))
    assert (
        straight_predictions(WALKS).at(times) == WALKS.positions[:, None] + WALKS.velocities[:, None] * times[:, None]
    ).all()
    assert straight_predictions(WALKS).mean_velocities(np.array((0.3, 2.0))) is WALKS.velocities


def test_between_two_times_and_beyond_the_last_places_lie_on_straight_lines():
    assert np.allclose(
        bent().at((0.5, 1.5, 3.0)), [[[1.25, 2.0], [1.5, 2.25], [1.5, 3.0]], [[0, -0.5], [0.5, -1], [2, -1]]]
    )


def test_velocities_lead_to_where_each_is_expected_at_its_time():
    assert np.allclose(bent().mean_velocities(np.array((1.0, 2.0))), [[0.5, 0.0], [0.5, -0.5]])


def test_deviations_follow_the_covariances_and_stay_as_they_are_beyond_them():
    assert np.allclose(bent().deviations((0.0, 1.0, 2.0, 9.0))[0], (0.2, 0.3, 0.4, 0.4))
    assert np.allclose(straight_predictions(WALKS).deviations((0.0, 2.0))[0], (0.2, np.sqrt(0.04 * (1.0 + 4.0))))


def test_rows_are_taken_of_every_array():
    alternatives = np.stack((BENT, BENT + 1.0))
    one = bent(alternatives=alternatives, weights=np.full((2, 2), 0.5)).take(np.array((1,)))
    assert one.means.shape == (1, 3, 2)
    assert one.alternatives.shape == (2, 1, 3, 2)
    assert one.weights.shape == (2, 1)
    assert (one.velocities == (1.0, 0.0)).all()


@pytest.mark.parametrize(
    ("said", "fault"),
    [
        (None, "NoneType; allowed: Predictions"),
        (bent(means=BENT * np.nan), "means that are not finite"),
        (bent(covariances=np.full((2, 3, 2, 2), np.inf)), "covariances that are not finite"),
        (bent(means=BENT[:1]), r"means of shape \(1, 3, 2\); allowed: \(2, 3, 2\) for 2 tracks"),
        (bent(means=BENT[:, :2]), r"means of shape \(2, 2, 2\)"),
        (bent(covariances=np.zeros((2, 3, 2))), r"covariances of shape \(2, 3, 2\)"),
        (bent(times=TIMES + 1.0), r"times \[1.0, 2.0, 3.0\]; allowed: rising from 0 s"),
        (bent(times=TIMES[::-1]), "times"),
        (bent(times=np.array((0.0, 1.0, np.nan))), "times"),
        (bent(means=BENT + 0.1), "a track 0.1 m off where it is now"),
        (bent(means=BENT.tolist()), "means that are no array of float64"),
        (bent(weights=np.ones((1, 2))), r"alternatives of shape \(0, 2, 3, 2\); allowed: \(1, 2, 3, 2\)"),
    ],
)
def test_what_is_no_prediction_is_refused_in_one_line(said, fault):
    with pytest.raises(InvalidPredictions, match=f"^Says.predict returned {fault}"):
        foresee(Says(said), view(tracks=WALKS))


def test_a_predictor_need_not_mend_what_a_tracker_got_wrong():
    lost = replace(WALKS, positions=np.array(((np.nan, 2.0), (0.0, 0.0))))
    foresee(Says(straight_predictions(lost)), view(tracks=lost))


def test_predictions_that_were_told_cannot_be_written_to():
    told = foresee(Says(bent()), view(tracks=WALKS))
    with pytest.raises(ValueError, match="read-only"):
        told.means[0, 0, 0] = 7.0


def test_without_a_predictor_everybody_keeps_their_velocity():
    assert (view(tracks=WALKS).predictions.at((2.0,))[0, 0] == (2.0, 2.0)).all()
    assert view(tracks=NO_TRACKS).predictions.means.shape == (0, 1, 2)


@pytest.mark.parametrize("name", ["constant_velocity", "learned", "truth"])
def test_installed_predictors_keep_the_contract(name):
    assert len(check("predictor", component("predictor", name), robot())) == 8


def test_a_predictor_that_jumps_breaks_the_contract():
    with pytest.raises(ContractViolation, match="predict returned means of shape"):
        check("predictor", Says(bent()), robot())
