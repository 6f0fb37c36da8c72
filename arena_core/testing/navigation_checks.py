"""The contracts of what plans, localises, maps, tracks and predicts around a planner."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from typing import Any

import numpy as np

from arena_core.base.errors import ContractViolation, NoPath
from arena_core.base.random_streams import random_generator
from arena_core.contracts.navigation import (
    GlobalPlanner,
    Localizer,
    LocalMap,
    PathBatch,
    Predictor,
    Tracker,
    WaypointGenerator,
)
from arena_core.loop.foreseeing import fault_of_predictions
from arena_core.testing import samples
from arena_core.testing.facts import Facts
from arena_core.values.geometry import Pose, Twist
from arena_core.values.predictions import Predictions
from arena_core.values.robot import Robot
from arena_core.values.sensing import Observation, Tracks
from arena_core.values.world import LETHAL, Costmap, OccupancyGrid

SLOT = np.zeros(1, np.int64)


def check_localizer(localizer: Localizer, body: Robot) -> Facts:
    """Localise along a straight drive in the walled room."""
    truth = [Pose(-1.0 + 0.05 * k, 0.3, 0.1) for k in range(41)]
    estimates = _run_localizer(localizer, body, truth)
    yield "poses are finite", all(np.isfinite(e.pose.array()).all() for e in estimates)
    covariances = np.array([e.covariance for e in estimates])
    yield (
        "covariances are symmetric and not negative",
        bool(
            np.allclose(covariances, covariances.transpose(0, 2, 1))
            and (np.linalg.eigvalsh(covariances) >= -1e-9).all()
        ),
    )
    yield "the estimate stays within 0.2 m on clean sensors", estimates[-1].pose.distance(truth[-1]) < 0.2
    again = _run_localizer(localizer, body, truth)
    yield "the same sensors after a reset give the same poses", [e.pose for e in again] == [e.pose for e in estimates]


def _run_localizer(localizer: Localizer, body: Robot, truth: Sequence[Pose]) -> list[Any]:
    localizer.reset(samples.room(), truth[0], random_generator(0, "sample/0", "localizer"))
    return [localizer.update(samples.sensors(pose, body, 0.1 * k, Twist(0.5))) for k, pose in enumerate(truth)]


def check_global_planner(planner: GlobalPlanner, body: Robot) -> Facts:
    """Plan in the walled room, free and divided."""
    start, goal = Pose(-3.0, -2.0, 0.0), Pose(3.0, 2.0, 0.0)
    path = planner.plan(samples.room(), start, goal)
    ends = path.poses[[0, -1], :2] - [(start.x, start.y), (goal.x, goal.y)]
    yield "the path runs from start to goal", bool(np.hypot(*ends.T).max() < 0.1)
    yield "the path is hardly longer than the straight line in a free room", path.length < 1.1 * start.distance(goal)
    yield (
        "the same query gives the same path",
        bool((planner.plan(samples.room(), start, goal).poses == path.poses).all()),
    )
    data = samples.room().data.copy()
    data[:, data.shape[1] // 2] = 100
    try:
        planner.plan(OccupancyGrid(data, samples.room().resolution, samples.room().origin), start, goal)
        yield "a divided room raises NoPath", False
    except NoPath:
        yield "a divided room raises NoPath", True


def check_waypoints(generator_: WaypointGenerator, body: Robot) -> Facts:
    """Follow a straight path."""
    path = samples.straight_path(Pose(-4.0, 0.0), Pose(4.0, 0.0))
    generator_.reset(SLOT, 1)
    for k in range(8):
        found = generator_.next(PathBatch.of([path]), np.array(((-4.0 + k, 0.05, 0.0),)), np.array((float(k),)))
        ok = found.poses.shape == (1, 3) and found.status.shape == (1,) and int(found.status[0]) == 0
        yield f"a robot {k} m along the path gets a waypoint on the path, ahead", ok and found.poses[0, 0] > -4.0 + k
    generator_.reset(np.arange(2), 2)
    pair = generator_.next(PathBatch.of([path, path]), np.array(((-4.0, 0.0, 0.0), (0.0, 0.0, 0.0))), np.zeros(2))
    generator_.reset(SLOT, 1)
    alone = generator_.next(PathBatch.of([path]), np.array(((-4.0, 0.0, 0.0),)), np.zeros(1))
    yield "a robot among others gets what it would get alone", bool((pair.poses[0] == alone.poses[0]).all())


def check_local_map(local_map: LocalMap, body: Robot) -> Facts:
    """Look at the wall of the room."""
    pose = Pose(4.0, 0.0, 0.0)
    for grid in (samples.room(), None):
        local_map.reset(grid)
        yield (
            "the wall is lethal, the robot's own place is not",
            _shows_wall(local_map.update(samples.scan(pose, body), pose)),
        )
        goal = Pose(-4.0, 0.0)
        planning = local_map.planning_grid(goal, all_marks=True)
        holds_goal = isinstance(planning, OccupancyGrid) and bool(planning.contains(planning.cells((goal.x, goal.y))))
        yield "a planning grid that holds the goal comes from it", holds_goal
        local_map.clear(pose, 0.0)
        yield (
            "once cleared, it shows the wall again at the next scan",
            _shows_wall(local_map.update(samples.scan(pose, body), pose)),
        )


def _shows_wall(window: Costmap) -> bool:
    """Return whether the wall at x = 5 m is lethal, and the place of a robot at x = 4 m is not."""
    cells = ((np.array(((4.97, 0.0), (4.0, 0.0))) - window.origin_xy) / window.resolution).astype(int)
    wall = window.costs[cells[0, 1], cells[0, 0] - 1 : cells[0, 0] + 2].max()
    return bool(wall == LETHAL and window.costs[cells[1, 1], cells[1, 0]] < LETHAL)


def check_tracker(tracker: Tracker, body: Robot) -> Facts:
    """Look at a room in which no one moves."""
    tracker.reset(samples.room())
    tracks = [
        tracker.update(samples.scan(Pose(0.0, 0.0), body, stamp=0.1 * k), Pose(0.0, 0.0), 0.1 * k) for k in range(10)
    ][-1]
    n = len(tracks.ids)
    shapes = (tracks.positions.shape, tracks.velocities.shape, tracks.radii.shape, tracks.covariances.shape)
    yield (
        "tracks have the documented shapes",
        isinstance(tracks, Tracks) and shapes == ((n, 2), (n, 2), (n,), (n, 4, 4)),
    )
    yield "an empty room has no fast track", bool((np.hypot(*tracks.velocities.T) < 0.5).all())


def check_predictor(predictor: Predictor, body: Robot) -> Facts:
    """Watch people walk through the walled room."""
    views = [samples.observation(body=body, stamp=0.1 * k, tracks=samples.people(0.1 * k)) for k in range(6)]
    seen = [view.tracks.positions.copy() for view in views]
    said = _predict_all(predictor, views)
    for one, view in zip(said, views, strict=True):
        if fault := fault_of_predictions(one, view.tracks):
            raise ContractViolation(f"predictor {type(predictor).__name__}: predict returned {fault}")
    yield "predictions are finite, have the documented shapes and begin where the tracks are", True
    covariances = np.concatenate([one.covariances.reshape(-1, 2, 2) for one in said])
    even = np.allclose(covariances, covariances.transpose(0, 2, 1))
    yield "covariances are symmetric and not negative", bool(even and (np.linalg.eigvalsh(covariances) >= -1e-9).all())
    several = [one.weights for one in said if len(one.weights)]
    weighed = all((each >= 0.0).all() and np.allclose(each.sum(axis=0), 1.0) for each in several)
    yield "weights of alternatives are not negative and add up to 1", weighed
    yield "the same observations after a reset give the same predictions", _alike(_predict_all(predictor, views), said)
    left = all((a == view.tracks.positions).all() for a, view in zip(seen, views, strict=True))
    yield "observations are left as they are", left
    yield "a deep copy goes on as it would, and both apart", _copies_predict_alike(predictor, views)
    nobody = predictor.predict(samples.observation(body=body, stamp=1.0))
    yield "without tracks there are no predictions", len(nobody.means) == 0
    predictor.reset(None)
    unknown = samples.observation(body=body, tracks=samples.people(0.0), known=False)
    yield "it works without a map", not fault_of_predictions(predictor.predict(unknown), unknown.tracks)


def _predict_all(predictor: Predictor, views: Sequence[Observation]) -> list[Predictions]:
    predictor.reset(samples.room())
    return [predictor.predict(view) for view in views]


def _alike(ones: Sequence[Predictions], others: Sequence[Predictions]) -> bool:
    both = zip(ones, others, strict=True)
    return all((getattr(a, name) == getattr(b, name)).all() for a, b in both for name in Predictions.__slots__)


def _copies_predict_alike(predictor: Predictor, views: Sequence[Observation]) -> bool:
    """Return whether a copy that is asked first says what the predictor then does."""
    _predict_all(predictor, views[:3])
    twins = deepcopy(predictor), predictor
    first, then = ([one.predict(view) for view in views[3:]] for one in twins)
    return _alike(first, then)
