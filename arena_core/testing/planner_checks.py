"""The contract of planners: driven in the walled room, and along a straight path."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy

from arena_core.base.errors import ArenaError, ContractViolation, NoValidCommand
from arena_core.contracts.navigation import Planner
from arena_core.loop.extras import kept_candidates
from arena_core.loop.navigator import check_command
from arena_core.loop.world_truth import WorldTruth
from arena_core.testing import samples
from arena_core.testing.facts import Facts
from arena_core.values.geometry import Pose, Twist
from arena_core.values.robot import Robot
from arena_core.values.sensing import Observation


def check_planner(planner: Planner, body: Robot) -> Facts:
    """Try a planner in the walled room."""
    views = samples.views(body)
    first = _drive_planner(planner, body, views)
    yield "every command is a finite Twist, or NoValidCommand is raised", True
    yield "the same observations after a reset give the same commands", _drive_planner(planner, body, views) == first
    _drive_planner(planner, body, views[::-1])
    yield "nothing of one episode survives into the next", _drive_planner(planner, body, views) == first
    seen = [v.scan.ranges.copy() for v in views]
    _drive_planner(planner, body, views)
    yield "telling what it considered changes no command", _drive_planner(planner, body, views, tells=True) == first
    yield "observations are left as they are", all((a == v.scan.ranges).all() for a, v in zip(seen, views, strict=True))
    yield "a deep copy goes on as it would, and both apart", _copies_decide_alike(planner, body, views)
    planner.reset(samples.episode_start(body, known=False))
    _ask_planner(planner, samples.observation(body=body, known=False))
    yield "it works without a map", True
    progress = _measure_true_progress if planner.privileged else _measure_progress
    yield "it approaches a waypoint on a free, straight path", progress(planner, body) > 0.2


def _drive_planner(
    planner: Planner, body: Robot, views: Sequence[Observation], *, tells: bool = False
) -> list[Twist | None]:
    planner.reset(samples.episode_start(body))
    return [_ask_planner(planner, view, tells=tells) for view in views]


def _copies_decide_alike(planner: Planner, body: Robot, views: Sequence[Observation]) -> bool:
    """Return whether a copy that is asked first answers as the planner then does."""
    planner.reset(samples.episode_start(body))
    for view in views[:3]:
        _ask_planner(planner, view)
    twins = deepcopy(planner), planner
    first, then = ([_ask_planner(one, view) for view in views[3:]] for one in twins)
    return first == then


def _ask_planner(planner: Planner, view: Observation, *, tells: bool = False) -> Twist | None:
    try:
        try:
            return check_command(planner.compute_velocity(view), planner)
        except NoValidCommand:
            return None
        finally:
            if tells:
                kept_candidates(planner.considered(), type(planner).__name__)
    except ArenaError as error:
        raise ContractViolation(str(error)) from error


def _measure_progress(planner: Planner, body: Robot) -> float:
    """Return how far 3 s of obeyed commands bring a robot along a straight, free path, as a part of the possible."""
    planner.reset(samples.episode_start(body))
    pose, twist, goal = Pose(-2.5, 0.0, 0.0), Twist(0.0), Pose(2.5, 0.0, 0.0)
    steps = round(3.0 / body.control_period)
    for k in range(steps):
        view = samples.observation(pose, Pose(pose.x + 2.0, 0.0), goal, twist, body, stamp=k * body.control_period)
        twist = _ask_planner(planner, view) or Twist(0.0)
        turned = Pose(pose.x, pose.y, pose.theta + 0.5 * twist.wz * body.control_period)
        moved = turned.compose(Pose(twist.vx * body.control_period, twist.vy * body.control_period))
        pose = Pose(moved.x, moved.y, pose.theta + twist.wz * body.control_period)
    return (pose.x + 2.5) / min(5.0, 3.0 * body.limits.vx_max)


def _measure_true_progress(planner: Planner, body: Robot) -> float:
    """Return how much nearer 3 s bring a robot to the goal of the world whose truth its planner sees, as a part of the
    possible.
    """
    loop, slot, problem = samples.driven_room(body)
    planner.see(WorldTruth(loop, slot, problem))
    planner.reset(samples.episode_start(body))
    before, steps = float(loop.goal_distances()[slot]), round(3.0 / body.control_period)
    for k in range(steps):
        state = loop.snapshot.state(slot)
        view = samples.observation(
            state.pose, problem.goal, problem.goal, state.twist, body, stamp=k * body.control_period
        )
        loop.drive((_ask_planner(planner, view) or Twist(0.0)).array()[None])
    return (before - float(loop.goal_distances()[slot])) / min(before, 3.0 * body.limits.vx_max)
