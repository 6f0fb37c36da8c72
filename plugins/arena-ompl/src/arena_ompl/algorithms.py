"""OMPL's planners by the names that users type, each made ready to search."""

from __future__ import annotations

from typing import Any, Literal

from ompl import geometric

Algorithm = Literal[
    "aorrtc",
    "bfmt",
    "bitstar",
    "bkpiece1",
    "fmt",
    "informed_rrtstar",
    "kpiece1",
    "lbkpiece1",
    "prm",
    "prmstar",
    "rrt",
    "rrtconnect",
    "rrtstar",
    "sorrtstar",
]

ROADMAPS = ("prm", "prmstar")
BATCHES = ("bfmt", "fmt")  # they draw all their samples first, and end when these are used up
# the first does not end with several goals, the second misses a third of the paths
NOT_FOR_CARS = ("aorrtc", "bitstar")
# they take a way back to be as long as the way there: BFMT* crashes, FMT* takes seconds
NOT_FOR_DUBINS = (*NOT_FOR_CARS, *BATCHES)
_ORDERED = 100  # samples that SORRT* orders at once; OMPL's 1000 would use up most evaluations before the first path

_CLASSES = {
    "aorrtc": "AORRTC",
    "bfmt": "BFMT",
    "bitstar": "BITstar",
    "bkpiece1": "BKPIECE1",
    "fmt": "FMT",
    "informed_rrtstar": "InformedRRTstar",
    "kpiece1": "KPIECE1",
    "lbkpiece1": "LBKPIECE1",
    "prm": "PRM",
    "prmstar": "PRMstar",
    "rrt": "RRT",
    "rrtconnect": "RRTConnect",
    "rrtstar": "RRTstar",
    "sorrtstar": "SORRTstar",
}


def make_planner(algorithm: Algorithm, space: Any, samples: int, motion_range: float | None) -> Any:
    """Return OMPL's planner for a space information; ``samples`` is for those that work on a batch."""
    planner = getattr(geometric, _CLASSES[algorithm])(space)
    if algorithm in BATCHES:
        planner.setNumSamples(samples)
    if algorithm == "sorrtstar":
        planner.setBatchSize(_ORDERED)
    if algorithm == "bitstar":
        planner.setPruning(False)  # with it OMPL 2.0.1 loops for ever, or crashes, behind a narrow door
    if motion_range is not None and hasattr(planner, "setRange"):
        planner.setRange(motion_range)
    return planner
