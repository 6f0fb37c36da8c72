"""The pack ``team``: how the robots of a team fared together, and each among the others (docs/teams.md)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from arena_core import EpisodeRecord, Metric, MetricPack
from arena_core.parameters import Positive
from arena_metrics.packs.bounds import with_bounds
from arena_metrics.packs.footprints import outline_distances

ROBOT = 3  # contact_kind of a contact with another robot
Rows = NDArray[np.float64]


class TeamMetrics(MetricPack):
    """Figures of teams, from the truth; empty where the robot was alone.

    A deadlock: for ``deadlock_time`` s none of two or more robots moves by ``stirs`` m or more whose episodes go on and
    who stand within ``cluster`` m of one another, from centre to centre, directly or through others of them.
    """

    def __init__(self, deadlock_time: Positive, stirs: Positive, cluster: Positive) -> None:
        self._deadlock_time, self._stirs, self._cluster = deadlock_time, stirs, cluster

    def metrics(self) -> Sequence[Metric]:
        """Return what the whole team did, then what its robot met."""
        metrics = [
            Metric(
                "all_succeed", "0/1", "higher", "every robot truly reached its goal in time", _of_teams(_all_arrive)
            ),
            Metric("makespan", "s", "lower", "time until the last one arrived, where all did", _of_teams(_makespan)),
            Metric("sum_of_times", "s", "lower", "sum of all times to goal, where all arrived", _of_teams(_sum)),
            Metric(
                "fairness", "s", "lower", "spread of delays: standard deviation over arrivals", _of_teams(_fairness)
            ),
            Metric("deadlocks", "-", "lower", "how often a cluster of robots got stuck", _of_teams(self.deadlocks)),
            Metric(
                "delay", "s", "lower", "own time to goal beyond the straight way at top speed", _of_teams(_own_delay)
            ),
            Metric("robot_collisions", "-", "lower", "contacts with other robots", _of_teams(_robot_collisions)),
            Metric("distance_min", "m", "higher", "least gap to another robot", _of_teams(_least_gap)),
        ]
        return with_bounds(metrics, signed=("delay",))

    def deadlocks(self, record: EpisodeRecord) -> float:
        """Count deadlocks of the team: a cluster counts again once one of its robots has moved."""
        stamps, places = record["team_stamp"], record["team_pose"][:, :, :2]
        width = int(np.searchsorted(stamps, stamps[0] + self._deadlock_time - 1e-9)) + 1
        if width > len(stamps):
            return 0.0
        windows = sliding_window_view(places, width, axis=0)
        still = (np.ptp(windows, axis=-1) < self._stirs).all(axis=-1)
        begun, before = 0, np.zeros(places.shape[1], bool)
        drives = np.array([stamps <= robot["end"] for robot in record.meta["team"]["robots"]]).T
        for step, rests in enumerate(still & drives[width - 1 :], width - 1):
            stuck = _clustered(places[step], rests, self._cluster)
            begun += int(_components(places[step], stuck & ~before, self._cluster))
            before = stuck
        return float(begun)


def _of_teams(compute: Callable[[EpisodeRecord], float]) -> Callable[[EpisodeRecord], float]:
    """Return what computes a figure where there is a team, else NaN."""

    def computed(record: EpisodeRecord) -> float:
        return compute(record) if "team" in record.meta else math.nan

    return computed


def _robots(record: EpisodeRecord) -> Sequence[Mapping[str, Any]]:
    robots: Sequence[Mapping[str, Any]] = record.meta["team"]["robots"]
    return robots


def _arrived(record: EpisodeRecord) -> list[Mapping[str, Any]]:
    return [robot for robot in _robots(record) if robot["outcome"] == "goal_reached"]


def _all_arrive(record: EpisodeRecord) -> float:
    return float(len(_arrived(record)) == len(_robots(record)))


def _times(record: EpisodeRecord) -> Rows:
    """Return the times to goal of all, s; NaN of those who did not arrive."""
    begin = float(record["team_stamp"][0])
    return np.array([r["end"] - begin if r["outcome"] == "goal_reached" else math.nan for r in _robots(record)])


def _makespan(record: EpisodeRecord) -> float:
    return float(_times(record).max())


def _sum(record: EpisodeRecord) -> float:
    return float(_times(record).sum())


def _delays(record: EpisodeRecord) -> Rows:
    """Return each time to goal beyond the straight way to the goal at the robot's greatest speed, s."""
    ways = np.array([math.dist(robot["start"][:2], robot["goal"][:2]) for robot in _robots(record)])
    fastest = np.array([_type_of(record, member)["limits"]["vx_max"] for member in range(len(ways))])
    return np.asarray(_times(record) - ways / fastest)


def _type_of(record: EpisodeRecord, member: int) -> Mapping[str, Any]:
    """Return what a record says of the type of a robot; older records have teams of one type."""
    kind: Mapping[str, Any] = _robots(record)[member].get("robot", record.meta["robot"])
    return kind


def _fairness(record: EpisodeRecord) -> float:
    delays = _delays(record)
    known = delays[np.isfinite(delays)]
    return float(known.std()) if len(known) > 1 else math.nan


def _own_delay(record: EpisodeRecord) -> float:
    return float(_delays(record)[record.meta["team"]["member"]])


def _robot_collisions(record: EpisodeRecord) -> float:
    return float(np.count_nonzero(record["contact_kind"] == ROBOT))


def _least_gap(record: EpisodeRecord) -> float:
    """Return the least distance between the outlines of this robot and another one while its episode went on, m."""
    member = record.meta["team"]["member"]
    poses = record["team_pose"][record["team_stamp"] <= record["stamp"][-1] + 1e-9]
    own = (poses[:, member], record.meta["robot"]["footprint"])
    others = [other for other in range(poses.shape[1]) if other != member]
    return min(_gap_between(own, (poses[:, other], _type_of(record, other)["footprint"])) for other in others)


def _gap_between(one: tuple[Rows, Mapping[str, Any]], two: tuple[Rows, Mapping[str, Any]]) -> float:
    """Return the least distance of two robots, each with its poses (S, 3) and its footprint, m."""
    vertices = [np.asarray(footprint["vertices_xy"]).reshape(-1, 2) for _, footprint in (one, two)]
    if not len(vertices[0]) and not len(vertices[1]):
        gaps = np.hypot(*(two[0][:, :2] - one[0][:, :2]).T) - one[1]["radius"] - two[1]["radius"]
        return max(float(gaps.min()), 0.0)
    least = math.inf
    for (poses, footprint), (theirs, shape), corners in ((one, two, vertices[1]), (two, one, vertices[0])):
        points = corners if len(corners) else np.zeros((1, 2))
        seen = _in_frame(poses, _placed(theirs, points)).reshape(-1, 2)
        away = float(outline_distances(footprint, seen).min()) - (0.0 if len(corners) else shape["radius"])
        least = min(least, max(away, 0.0))
    return least


def _placed(poses: Rows, points: Rows) -> Rows:
    """Return points (V, 2) of a robot's frame at its poses (S, 3) in ``map``, (S, V, 2)."""
    c, s = np.cos(poses[:, None, 2]), np.sin(poses[:, None, 2])
    turned = np.stack((c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]), axis=-1)
    return np.asarray(turned + poses[:, None, :2])


def _in_frame(poses: Rows, points: Rows) -> Rows:
    """Return points (S, V, 2) of ``map`` in the frame of a robot at these poses (S, 3)."""
    away = points - poses[:, None, :2]
    c, s = np.cos(poses[:, None, 2]), np.sin(poses[:, None, 2])
    return np.stack((c * away[..., 0] + s * away[..., 1], c * away[..., 1] - s * away[..., 0]), axis=-1)


def _clustered(places: Rows, rests: NDArray[np.bool_], reach: float) -> NDArray[np.bool_]:
    """Return which of those who rest have another one who rests within ``reach`` m."""
    near = np.hypot(*(places[:, None] - places).transpose(2, 0, 1)) <= reach
    return np.asarray(rests & ((near & rests).sum(axis=1) > 1))


def _components(places: Rows, chosen: NDArray[np.bool_], reach: float) -> int:
    """Count the clusters of the chosen ones: those within ``reach`` m of one another, directly or through others."""
    left, found = set(np.flatnonzero(chosen).tolist()), 0
    while left:
        found += 1
        open_ones = [left.pop()]
        while open_ones:
            at = open_ones.pop()
            reached = {k for k in left if math.dist(places[at], places[k]) <= reach}
            left -= reached
            open_ones.extend(reached)
    return found
