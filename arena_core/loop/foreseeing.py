"""What a predictor says, held against what predictions are."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from arena_core.base.errors import InvalidPredictions
from arena_core.base.frozen import freeze_array
from arena_core.contracts.navigation import Predictor
from arena_core.values.predictions import Predictions
from arena_core.values.sensing import Observation, Tracks

NEAR = 1e-3  # m, that a prediction for now may be off the track


def foresee(predictor: Predictor, observation: Observation) -> Predictions:
    """Return what a predictor says of an observation, which no one can change any more; raise InvalidPredictions."""
    return check_predictions(predictor.predict(observation), predictor, observation.tracks)


def check_predictions(said: Predictions, predictor: Predictor, tracks: Tracks) -> Predictions:
    """Return what a predictor said of tracks, which no one can change any more; raise InvalidPredictions."""
    if fault := fault_of_predictions(said, tracks):
        raise InvalidPredictions(f"{type(predictor).__name__}.predict returned {fault}")
    return Predictions(*(freeze_array(getattr(said, each.name)) for each in fields(said)))


def fault_of_predictions(said: object, tracks: Tracks) -> str:
    """Return what is wrong with predictions of these tracks, and what is allowed; empty where nothing is."""
    if not isinstance(said, Predictions):
        return f"{type(said).__name__}; allowed: Predictions"
    arrays = {each.name: getattr(said, each.name) for each in fields(said)}
    for name, array in arrays.items():
        if not isinstance(array, np.ndarray) or array.dtype != np.float64:
            return f"{name} that are no array of float64; allowed: one"
    if fault := _fault_of_times(said):
        return fault
    for name, shape in _shapes(said, len(tracks.ids)).items():
        if arrays[name].shape != shape:
            return f"{name} of shape {arrays[name].shape}; allowed: {shape} for {len(tracks.ids)} tracks"
    return _fault_of_numbers(said, tracks)


def _fault_of_times(said: Predictions) -> str:
    times = said.times
    if times.ndim != 1 or not len(times) or times[0] != 0.0 or not (np.diff(times) > 0.0).all():
        return f"times {times.tolist()}; allowed: rising from 0 s"
    return "" if np.isfinite(times[-1]) else "times that are not finite; allowed: finite numbers"


def _shapes(said: Predictions, count: int) -> dict[str, tuple[int, ...]]:
    """Return which shape each array has to have, of ``count`` tracks."""
    steps, several = len(said.times), len(said.weights)
    return {
        "means": (count, steps, 2),
        "covariances": (count, steps, 2, 2),
        "velocities": (count, 2),
        "spreads": (count, 4, 4),
        "alternatives": (several, count, steps, 2),
        "weights": (several, count),
    }


def _fault_of_numbers(said: Predictions, tracks: Tracks) -> str:
    """Return which number is none, or no place of the track; what a tracker says of one may be none itself."""
    names = ("means", "covariances", "velocities", "spreads")
    if not all(np.isfinite(getattr(said, name)).all() for name in (*names, "alternatives", "weights")):
        known = [np.isfinite(each).reshape(len(tracks.ids), -1).all(axis=1) for each in _told(tracks)]
        rows = np.logical_and.reduce(known)
        for name in names:
            if not np.isfinite(getattr(said, name)[rows]).all():
                return f"{name} that are not finite; allowed: finite numbers"
        if not np.isfinite(said.alternatives[:, rows]).all() or not np.isfinite(said.weights[:, rows]).all():
            return "alternatives or weights that are not finite; allowed: finite numbers"
    off = np.abs(said.means[:, 0] - tracks.positions)
    if (off > NEAR).any():
        return f"a track {np.nanmax(off):.3g} m off where it is now; allowed: means that begin at the tracks"
    return ""


def _told(tracks: Tracks) -> tuple[np.ndarray, ...]:
    return tracks.positions, tracks.velocities, tracks.covariances
