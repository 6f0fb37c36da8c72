"""A navigator of parts that note what they are asked and say what they are told to: what its tests drive."""

from dataclasses import replace

import numpy as np

from arena_core import (
    INSCRIBED,
    NO_TRACKS,
    GlobalPlanner,
    Localizer,
    LocalMap,
    NoPath,
    Planner,
    Pose,
    PoseEstimate,
    Tracker,
    Twist,
    WaypointGenerator,
    Waypoints,
)
from arena_core.hosting import WAYPOINT_FOUND
from arena_core.loop.guide import GuideParts, Mission, ReplanRules
from arena_core.loop.navigator import Navigator
from arena_core.loop.recovery import RecoveryRules
from arena_core.testing import free_costmap, robot, room, sensors, straight_path

GOAL = Pose(3.0, 0.0)
WHEN_ASKED = ReplanRules(None, True, None, 0.0, 0.0)
NO_RECOVERIES = RecoveryRules([], 0.5, 10.0, 3.0, 3.0, 5.0, 1.57, 1.0, 0.3, 0.15, 0.5, 0.4, 60.0, 0.3, 2.0, None, None)


class Odometer(Localizer):
    """Believes its odometry."""

    def reset(self, grid, start, random):
        pass

    def update(self, sensors):
        return PoseEstimate(sensors.odometry.pose, np.zeros((3, 3)))


class Straight(GlobalPlanner):
    """Plans straight lines, unless there is no way; ``detour`` times its length is what the old path costs."""

    def __init__(self):
        self.grids, self.no_way, self.closed, self.paths, self.detour = [], False, [], [], 1.0
        self.refuses_obstacles = False

    def plan(self, grid, start, goal):
        self.grids.append(grid)
        detour = self.refuses_obstacles and grid.occupied.sum() > room().occupied.sum()
        if self.no_way or detour or any(grid is closed for closed in self.closed):
            raise NoPath("walled in")
        self.paths.append(straight_path(start, goal))
        return self.paths[-1]

    def cost(self, grid, path):
        return path.length if path is self.paths[-1] else self.detour * path.length


class Ahead(WaypointGenerator):
    """Puts the waypoint at the path's end and says what it is told to say, once."""

    def __init__(self):
        self.status, self.resets = WAYPOINT_FOUND, 0

    def reset(self, slots, total):
        self.resets += 1

    def next(self, paths, poses, stamps, slots=None):
        status, self.status = self.status, WAYPOINT_FOUND
        return Waypoints(paths.poses[-1:], np.array((status,), np.int8))


class Window(LocalMap):
    """Shows a given costmap and counts how often it was asked."""

    def __init__(self):
        self.costmap, self.asked, self.poses = free_costmap(Pose(0.0, 0.0)), 0, []
        self.grid, self.lenient, self.cleared = room(), room(), []

    def reset(self, grid):
        pass

    def update(self, scan, pose):
        self.asked += 1
        self.poses.append(pose)
        return self.costmap

    def planning_grid(self, goal, all_marks):
        assert goal == GOAL
        return self.grid if all_marks else self.lenient

    def clear(self, pose, beyond):
        self.cleared.append((pose, beyond, self.asked))


class Nobody(Tracker):
    def reset(self, grid):
        pass

    def update(self, scan, pose, stamp):
        return NO_TRACKS


class Says(Planner):
    """Returns, or raises, what it is told, and keeps what it saw."""

    def __init__(self, answer):
        self.answer, self.seen, self.started = answer, [], None

    def reset(self, episode):
        self.started = episode

    def compute_velocity(self, observation):
        self.seen.append(observation)
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer(observation) if callable(self.answer) else self.answer


def drive(answer=Twist(0.5), rules=WHEN_ASKED, map=room(), recoveries=NO_RECOVERIES):  # noqa: B008 - both are frozen
    """Return a navigator that stands ready in the walled room; ``map`` None: an unknown world."""
    navigator = Navigator(
        GuideParts(robot(), Odometer(), Straight(), Ahead(), Window(), Nobody()), Says(answer), rules, recoveries, 0.1
    )
    navigator.reset(Mission(map, Pose(0.0, 0.0), GOAL, 0.3, 7, "sample/0"))
    return navigator


def at(x, stamp=0.0, **changes):
    return replace(sensors(Pose(x, 0.0), robot(), stamp), **changes)


def reasons(decision):
    return [(event.kind, event.detail) for event in decision.events]


def block(navigator, x):
    """Put an obstacle on the path at ``x``."""
    costs = np.zeros_like(navigator.local_map.costmap.costs)
    window = navigator.local_map.costmap
    column = int((x - window.origin_xy[0]) / window.resolution)
    costs[:, column] = INSCRIBED
    navigator.local_map.costmap = replace(window, costs=costs)
