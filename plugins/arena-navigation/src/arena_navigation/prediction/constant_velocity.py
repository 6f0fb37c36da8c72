"""The predictor that expects everybody to go on as they go."""

from __future__ import annotations

from arena_core import Observation, OccupancyGrid, Predictions, Predictor


class ConstantVelocity(Predictor):
    """Expect each track to keep its velocity; it is as unsure as the track is."""

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode; there is nothing to keep."""

    def predict(self, observation: Observation) -> Predictions:
        """Return straight lines."""
        tracks = observation.tracks
        return Predictions.straight(tracks.positions, tracks.velocities, tracks.covariances)
