"""Every installed planner answers bad input with a finite command or a refusal, never with an
exception or a number that is none.
"""

from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

from arena_core import LETHAL, ConfigurationError, Costmap, NoValidCommand, Path, Pose, Tracks
from arena_core.loop.navigator import check_command
from arena_core.testing import component, free_costmap, observation, planner, robot
from arena_core.testing.samples import truth
from tests.conftest import of_the_suite

BODY = robot()
OUTSIDE = ("ros_external",)  # its commands come from another process: arena-ros has tests of its own
HERE = Pose(0.0, 0.0, 0.0)


def costmap_with(blocked):
    """Return the window around the robot with these cells lethal."""
    free = free_costmap(HERE)
    gaps = np.hypot(*(np.argwhere(blocked)[None] - np.argwhere(~blocked)[:, None]).transpose(2, 0, 1)).min(axis=1)
    distance = np.zeros(blocked.shape, np.float32)
    distance[~blocked] = gaps * free.resolution
    costs = np.where(blocked, LETHAL, np.where(distance <= BODY.footprint.inscribed_radius, LETHAL - 1, 0)).astype(
        np.uint8
    )
    return Costmap(costs, distance, free.resolution, free.origin_xy)


def clusters():
    """Two hundred posts of one cell, none near the robot."""
    blocked = np.zeros((120, 120), np.bool_)
    cells = np.random.default_rng(0).permutation(120 * 120)
    rows, columns = np.divmod(cells, 120)
    far = np.hypot(rows - 60, columns - 60) > 16
    blocked[rows[far][:200], columns[far][:200]] = True
    return costmap_with(blocked)


def goal_on_an_obstacle():
    blocked = np.zeros((120, 120), np.bool_)
    blocked[54:66, 94:110] = True
    return costmap_with(blocked)


def crowd():
    """Two hundred tracks that move, none on the robot."""
    random = np.random.default_rng(1)
    angles, distances = random.uniform(-np.pi, np.pi, 200), random.uniform(1.0, 6.0, 200)
    positions = np.column_stack((np.cos(angles), np.sin(angles))) * distances[:, None]
    shapes = np.full(200, 0.3), np.tile(0.01 * np.eye(4), (200, 1, 1))
    return Tracks(np.arange(200, dtype=np.int32), positions, random.normal(0.0, 0.5, (200, 2)), *shapes)


def with_scan(body, value):
    usual = observation(body=body)
    return replace(usual, scan=replace(usual.scan, ranges=np.full_like(usual.scan.ranges, value)))


VIEWS = {
    "an empty path": lambda body: replace(observation(body=body), path=Path(np.empty((0, 3)))),
    "a path of one pose": lambda body: replace(observation(body=body), path=Path(np.zeros((1, 3)))),
    "a path of equal poses": lambda body: replace(observation(body=body), path=Path(np.tile((1.0, 0.0, 0.0), (5, 1)))),
    "a scan of NaN": lambda body: with_scan(body, np.nan),
    "a scan of inf": lambda body: with_scan(body, np.inf),
    "a goal on an obstacle": lambda body: observation(body=body, costmap=goal_on_an_obstacle()),
    "two hundred clusters": lambda body: observation(body=body, costmap=clusters()),
    "two hundred tracks": lambda body: replace(observation(body=body), _tracks=crowd),
}


@pytest.fixture(scope="module", params=[name for name in of_the_suite("planner") if name not in OUTSIDE])
def built(request):
    """Return a planner and its robot: the sample, or a Jackal where a policy knows real robots alone."""
    body = BODY
    try:
        made = planner(request.param, body)
    except ConfigurationError:
        body = component("robot", "jackal")
        made = planner(request.param, body)
    if made.privileged:
        made.see(truth(body))
    return made, body


@pytest.mark.parametrize("view", VIEWS)
def test_bad_input_is_answered_with_a_finite_command_or_refused(built, view):
    asked, body = built
    with suppress(NoValidCommand):
        check_command(asked.compute_velocity(VIEWS[view](body)), asked)
