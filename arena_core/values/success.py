"""What counts as success: the paper's word, shared by metrics and by tasks that adapt."""

from __future__ import annotations

import math

from arena_core.values.episode import EpisodeRecord

# m that the true position may be off beyond the goal radius: the estimate, not the truth, ends an episode
ARRIVAL_SLACK = 0.25
COLLISIONS_ALLOWED = 1  # "fewer than two" (Kaestner et al. 2022, table I)


def is_success(record: EpisodeRecord, collisions_allowed: int = COLLISIONS_ALLOWED) -> bool:
    """Return whether the true goal was reached, in time, with few enough collisions."""
    scenario = record.meta["scenario"]
    off = math.dist(record["pose"][-1, :2], scenario["goal"][:2])
    arrived = record.meta["outcome"] == "goal_reached" and off <= scenario["goal_radius"] + ARRIVAL_SLACK
    in_time = record["stamp"][-1] <= scenario["time_limit"] + 1e-9
    return bool(arrived and in_time and len(record["contact_stamp"]) <= collisions_allowed)
