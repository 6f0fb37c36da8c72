"""How sure figures are: intervals over problems, comparisons of pairs, interquartile means, scores over training seeds.

Report, claims, leaderboard, studio and trainings say what these return. Nothing here knows of planners, tables or
pages. Intervals and tests need scipy: ``pip install arena-core[statistics]``, or arena-metrics, which brings it.
"""

from arena_core.statistics.aggregates import interquartile_mean, middle_half
from arena_core.statistics.clusters import MOST_RESAMPLED, Clusters, make_clusters
from arena_core.statistics.comparisons import ALPHA, WORTH, Comparison, after_holm, compare, estimate_difference
from arena_core.statistics.intervals import LEAST_PROBLEMS, TAIL, Estimate, FloatArray, Kind, Labels, Method, estimate
from arena_core.statistics.seeds import over_seeds, wilson

__all__ = [
    "ALPHA",
    "LEAST_PROBLEMS",
    "MOST_RESAMPLED",
    "TAIL",
    "WORTH",
    "Clusters",
    "Comparison",
    "Estimate",
    "FloatArray",
    "Kind",
    "Labels",
    "Method",
    "after_holm",
    "compare",
    "estimate",
    "estimate_difference",
    "interquartile_mean",
    "make_clusters",
    "middle_half",
    "over_seeds",
    "wilson",
]
