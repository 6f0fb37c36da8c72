"""The predictor that has learned where people will be."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from arena_core import InputFileError, Observation, OccupancyGrid, Predictions, Predictor
from arena_core.files import local_path
from arena_policies.encoding import all_finite
from arena_prediction.card import PredictorCard, load_network
from arena_prediction.features import TrackMemory
from arena_prediction.hypotheses import AnswerReader
from arena_prediction.trust import Trust, TrustRules


class LearnedPredictor(Predictor):
    """Expect of each track what a network does: from two seconds of its way, its neighbours and the walls around.

    ``network`` is the address of an ONNX file with its card beside it. The most probable hypothesis are the means; all
    of them are alternatives, with their weights. After the network's last time each keeps its velocity. Where people do
    other things than the network expects, the most probable way is nearer to the straight line (``trust``).
    """

    def __init__(self, network: str, trust: TrustRules) -> None:
        self._path: Path = local_path(network)
        self.card: PredictorCard
        self.card, self._network = load_network(self._path)
        times = np.array((0.0, *self.card.times))
        self._reader = AnswerReader(times, self.card.hypotheses, np.array((1.0, *self.card.widths)))
        self._memory, self._trust = TrackMemory(), Trust(trust, times, self.card.hypotheses)

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode; no one has been seen."""
        self._memory.reset(grid)
        self._trust.reset()

    def predict(self, observation: Observation) -> Predictions:
        """Return where the tracks will be; raise InputFileError where the network answers with no number."""
        tracks = observation.tracks
        if not len(tracks.ids):
            return Predictions.straight(tracks.positions, tracks.velocities, tracks.covariances)
        numbers, frames = self._memory.encode(tracks, observation.stamp)
        answers = self._network.run(numbers)
        if not all_finite(answers):
            raise InputFileError(f"{self._path}: answers with values that are not finite; allowed: finite numbers")
        share = self._trust.judge(tracks, observation.stamp)
        self._trust.expect(tracks, observation.stamp, frames, answers)
        return self._reader.predictions(tracks, frames, answers, share)
