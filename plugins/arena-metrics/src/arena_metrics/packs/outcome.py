"""How an episode ended: success, collisions, goal error, time, and what the navigator met on the way."""

from __future__ import annotations

import math

import numpy as np

from arena_core import EpisodeRecord
from arena_core.records import is_success
from arena_metrics.packs.motion import polyline_length

PERSON = 2  # contact_kind of a contact with a person


def collision_count(record: EpisodeRecord) -> float:
    """Count contacts by their rising edges."""
    return float(len(record["contact_stamp"]))


def collisions_caused(record: EpisodeRecord) -> float:
    """Count contacts in which the robot moved into the other."""
    return float(np.count_nonzero(record["contact_caused"]))


def collisions_people(record: EpisodeRecord) -> float:
    """Count contacts with people."""
    return float(np.count_nonzero(record["contact_kind"] == PERSON))


def collisions_people_caused(record: EpisodeRecord) -> float:
    """Count contacts with people in which the robot moved into the person."""
    return float(np.count_nonzero((record["contact_kind"] == PERSON) & record["contact_caused"]))


def collisions_static(record: EpisodeRecord) -> float:
    """Count contacts with walls and obstacles, which the robot always causes."""
    return float(np.count_nonzero(record["contact_kind"] < PERSON))


def contact_time(record: EpisodeRecord) -> float:
    """Return the time in contact, s."""
    return float(record["contact_time"].sum())


def impact_speed(record: EpisodeRecord) -> float:
    """Return the highest closing speed at a contact, m/s; NaN without contact."""
    speeds = record["contact_speed"]
    return float(speeds.max()) if len(speeds) else math.nan


def goal_error(record: EpisodeRecord) -> float:
    """Return the true distance to the goal at the end, m."""
    goal = record.meta["scenario"]["goal"]
    return float(math.dist(record["pose"][-1, :2], goal[:2]))


def episode_duration(record: EpisodeRecord) -> float:
    """Return the length of the episode, s."""
    return float(record["stamp"][-1] - record["stamp"][0])


def time_to_goal(record: EpisodeRecord) -> float:
    """Return the time until arrival, s; NaN unless the goal was reached."""
    return episode_duration(record) if record.meta["outcome"] == "goal_reached" else math.nan


def episode_success(record: EpisodeRecord) -> float:
    """Return 1 for an arrival near the true goal, in time, with fewer than two collisions, else 0: the core's word."""
    return float(is_success(record))


def strict_success(record: EpisodeRecord) -> float:
    """Return 1 for a success without any collision, else 0."""
    return float(is_success(record, collisions_allowed=0))


def spl_value(record: EpisodeRecord) -> float:
    """Return success weighted by path length (Anderson et al. 2018, section 3.1), the first
    global path being the shortest one.
    """
    if not is_success(record):
        return 0.0
    shortest = _first_path_length(record)
    longest = max(polyline_length(record["pose"][:, :2]), shortest)
    return shortest / longest if longest > 0.0 else 1.0


def _first_path_length(record: EpisodeRecord) -> float:
    """Return the length of the first global path, m, or of the straight line where no path was recorded."""
    offsets = record["path_offsets"]
    if len(offsets) > 1:
        return polyline_length(record["path_poses"][offsets[0] : offsets[1], :2])
    return float(math.dist(record.meta["scenario"]["start"][:2], record.meta["scenario"]["goal"][:2]))


def rejected_steps(record: EpisodeRecord) -> float:
    """Count the control steps in which the planner had no valid command."""
    return float(sum(event["kind"] == "no_valid_command" for event in record.meta["events"]))


def replan_count(record: EpisodeRecord) -> float:
    """Count the requests for a new global path after the first one."""
    return float(sum(event["kind"] == "replan" and event["detail"] != "start" for event in record.meta["events"]))


def recovery_count(record: EpisodeRecord) -> float:
    """Count the recovery behaviours that were tried."""
    return float(sum(event["kind"] == "recovery" for event in record.meta["events"]))


def localization_error(record: EpisodeRecord) -> float:
    """Return the mean distance between estimated and true position, m; NaN without an estimate."""
    errors = np.hypot(*(record["estimate"][:, :2] - record["pose"][:, :2]).T)
    known = errors[np.isfinite(errors)]
    return float(known.mean()) if len(known) else math.nan
