"""`arena predict measure`: all predictors on the same tracks, held against where people truly were."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from arena_core import ArenaError, ConfigurationError, Predictions, Predictor, Tracks, testing
from arena_prediction.drives import Drive, WatchingPlanner
from arena_prediction.measure import measure, scores_of
from arena_prediction.predict_command import PredictCommand
from arena_prediction.scores import summarise

TIMES = np.array((0.2, 0.4))
HALL = (
    "world=empty",
    "world.width=8",
    "world.height=8",
    "robot=jackal",
    "planner=pure_pursuit",
    "localizer=ground_truth",
    "tracker=ground_truth",
    "task.pedestrians=4",
    "task.time_limit=6",
    "pedestrians.reaction=ignore",
    "episodes=1",
    "seed=3",
)


def bending_drive(offset=0.1, steps=9):
    """Return a drive in which a person walks a parabola, and its track stands off by ``offset`` m at its velocity."""
    stamps = 0.1 * np.arange(steps)
    people = np.stack((stamps, stamps**2), axis=1)[:, None]
    velocities = np.stack((np.ones(steps), 2.0 * stamps), axis=1)[:, None]
    rows = np.concatenate((people[:, 0] + (offset, 0.0), velocities[:, 0]), axis=1)
    tracks = tuple(testing.tracked(tuple(row)) for row in rows)
    return Drive(stamps, tracks, None, people, velocities, np.array((0.3,)))


def straight_said(driven):
    return [{"straight": Predictions.straight(t.positions, t.velocities, t.covariances)} for t in driven.tracks]


def watched(driven):
    return SimpleNamespace(predictors={"straight": None}, said=straight_said(driven))


def test_a_track_is_held_against_where_its_person_then_was():
    driven = bending_drive()
    found = summarise(scores_of(driven, watched(driven), TIMES)["straight"], 0.5)
    assert found.tracks == 2  # every 0.3 s, as long as there are 0.4 s left
    assert found.fde == pytest.approx(np.hypot(0.1, 0.4**2))
    assert found.ade == pytest.approx((np.hypot(0.1, 0.2**2) + np.hypot(0.1, 0.4**2)) / 2)


def test_a_track_that_is_no_ones_counts_for_nothing():
    driven = bending_drive(offset=0.7)
    assert len(scores_of(driven, watched(driven), TIMES)["straight"].errors) == 0


def test_people_who_leave_before_the_horizon_count_for_nothing():
    driven = bending_drive()
    driven.people[5:] = np.nan
    assert len(scores_of(driven, watched(driven), TIMES)["straight"].errors) == 1


def test_the_truth_errs_in_nothing_and_straight_lines_do():
    found = measure([*HALL, "predictor.horizon=2.0"], ["truth", "constant_velocity"], 1.0, 0.5)
    truth, straight = (found[name].summary for name in ("truth", "constant_velocity"))
    assert truth.tracks == straight.tracks > 20
    assert truth.ade < 0.01 < straight.ade
    assert straight.min_ade == straight.ade


def test_measuring_is_the_same_every_time():
    one, same = (measure(HALL, ["constant_velocity"], 1.0, 0.5)["constant_velocity"].summary for _ in range(2))
    assert one == same


class Wrong(Predictor):
    def reset(self, grid):
        pass

    def predict(self, observation):
        tracks = observation.tracks
        return Predictions.straight(tracks.positions, np.full_like(tracks.velocities, np.nan), tracks.covariances)


def test_a_predictor_that_says_no_number_is_named_in_one_line():
    view = testing.observation(body=testing.robot(), tracks=testing.people(0.0))
    watching = WatchingPlanner(testing.planner("pure_pursuit", testing.robot()), {"wrong": Wrong()})
    with pytest.raises(ArenaError, match=r"^Wrong\.predict returned velocities that are not finite; allowed: finite"):
        watching.compute_velocity(view)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["everything"], "stage is everything; allowed: train, measure"),
        (["measure", "predictor=truth,truth"], "predictor is truth,truth; allowed: several, each once"),
        (["measure", "horizon=0"], "horizon"),
        (["measure", "miss=-1"], "miss"),
        (["measure", "predictor=constant_velocity", "predictor.horizon=1.0", *HALL], "predictor.horizon=1.0: no param"),
        (["measure", "predictor=nobody", *HALL], "nobody"),
        (["measure", "predictor=constant_velocity", *HALL, "task.pedestrians=0"], "no track was seen for 2 s on end"),
    ],
)
def test_what_cannot_be_measured_is_refused_in_one_line(words, said):
    with pytest.raises(ConfigurationError) as error:
        PredictCommand().run(words)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_table_has_a_line_for_each_predictor(capsys):
    assert PredictCommand().run(["measure", "predictor=constant_velocity,truth", "horizon=1.0", *HALL]) == 0
    header, straight, truth = capsys.readouterr().out.splitlines()
    assert header.split()[:2] == ["predictor", "tracks"]
    assert (straight.split()[0], truth.split()[0]) == ("constant_velocity", "truth")
    assert straight.split()[3] == "1.00"


def test_empty_steps_have_no_scores():
    driven = bending_drive()
    nothing = Tracks(*(getattr(driven.tracks[0], name)[:0] for name in Tracks.__slots__))
    empty = Drive(driven.stamps, (nothing,) * len(driven.stamps), None, driven.people, driven.velocities, driven.radii)
    assert len(scores_of(empty, watched(empty), TIMES)["straight"].errors) == 0
