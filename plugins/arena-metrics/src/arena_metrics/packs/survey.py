"""The pack ``survey``: how people rated the drives that they were shown."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from arena_core import ConfigurationError, EpisodeRecord, Metric, MetricPack
from arena_core.records import record_digest
from arena_metrics.packs.ratings import read_ratings


class SurveyMetrics(MetricPack):
    """Ratings of records by people, empty for records that nobody rated.

    ``path`` is a file of ratings, or a folder of them.
    """

    def __init__(self, path: str | None) -> None:
        if path is None:
            raise ConfigurationError("metrics.survey.path is null; allowed: a file of ratings, or a folder of them")
        self._ratings = read_ratings(Path(path))

    def metrics(self) -> Sequence[Metric]:
        """Return the mean of the ratings of a drive, how they differ, and how many there are."""
        return [
            Metric("rating", "-", "higher", "mean of people's ratings, 0 to 1", self.rating),
            Metric("disagreement", "-", "neither", "standard deviation of the ratings of one drive", self.disagreement),
            Metric("ratings", "-", "neither", "ratings of this drive", lambda record: len(self._scores(record))),
        ]

    def rating(self, record: EpisodeRecord) -> float:
        """Return the mean of the scores."""
        scores = self._scores(record)
        return float(np.mean(scores)) if scores else math.nan

    def disagreement(self, record: EpisodeRecord) -> float:
        """Return the sample standard deviation of the scores, NaN below two."""
        scores = self._scores(record)
        return float(np.std(scores, ddof=1)) if len(scores) > 1 else math.nan

    def _scores(self, record: EpisodeRecord) -> Sequence[float]:
        return self._ratings.get(record_digest(record), ())
