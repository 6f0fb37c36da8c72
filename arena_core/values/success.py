"""What counts as success: the paper's word, shared by metrics and by tasks that adapt."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from arena_core.values.episode import EpisodeRecord

# m that the true position may be off beyond the goal radius: the estimate, not the truth, ends an episode
ARRIVAL_SLACK = 0.25
AT_WAYPOINT = 0.5  # m from its last waypoint within which a person has arrived (the radius of waypoints)
COLLISIONS_ALLOWED = 1  # "fewer than two" (Kaestner et al. 2022, table I)


def is_success(record: EpisodeRecord, collisions_allowed: int = COLLISIONS_ALLOWED) -> bool:
    """Return whether the true goal was reached, in time, with few enough collisions; with a person, if there is one to
    follow.
    """
    scenario = record.meta["scenario"]
    off = math.dist(record["pose"][-1, :2], scenario["goal"][:2])
    arrived = record.meta["outcome"] == "goal_reached" and off <= _goal_tolerance(scenario)
    in_time = record["stamp"][-1] <= scenario["time_limit"] + 1e-9
    return bool(arrived and in_time and len(record["contact_stamp"]) <= collisions_allowed)


def _goal_tolerance(scenario: Mapping[str, Any]) -> float:
    """Return how far from the scenario's goal an episode may end, m: there stands the person who was followed. Who runs
    errands ends anywhere.
    """
    if "errands" in scenario:
        return math.inf
    company = scenario.get("company")
    if company is None or company["manner"] == "lead":
        return float(scenario["goal_radius"]) + ARRIVAL_SLACK
    return float(company["farthest"]) + AT_WAYPOINT + ARRIVAL_SLACK
