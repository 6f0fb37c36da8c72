"""Small, plain values for tests: a robot, a walled room, what one sees there, a scenario, a record."""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import deepcopy
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pluggy import PluginManager

from arena_core.base.errors import ConfigurationError
from arena_core.base.frozen import freeze_array
from arena_core.base.random_streams import random_generator
from arena_core.config.configuration import compose, to_plain
from arena_core.config.furniture import furniture_kind
from arena_core.config.option_folders import own_folder
from arena_core.config.registry import Registry, load_registry
from arena_core.contracts.navigation import Planner
from arena_core.contracts.truth import Truth
from arena_core.loop.episode_loop import EpisodeLoop
from arena_core.loop.execution import Timing
from arena_core.loop.navigator import NO_TIME, Decision, Spent
from arena_core.loop.observing import make_observation
from arena_core.loop.recording import Recorder
from arena_core.loop.warm_up import walled_room
from arena_core.loop.world_truth import WorldTruth
from arena_core.runs.jobs.benchmark import metric_packs
from arena_core.testing.views import tracked
from arena_core.values.episode import Contact, EpisodeRecord, EpisodeStart, Event, Scenario, WorldState
from arena_core.values.geometry import FloatArray, Footprint, Pose, Twist
from arena_core.values.robot import Kinematics, Lidar, OdometryModel, Robot, VelocityLimits
from arena_core.values.sensing import NO_TRACKS, LaserScan, Observation, Odometry, PoseEstimate, Sensors, Tracks
from arena_core.values.world import (
    ABSENT,
    LETHAL,
    Costmap,
    Furniture,
    OccupancyGrid,
    Path,
    Pedestrians,
    PedestrianSpec,
    World,
)

IDEAL = Timing("ideal", 0.0, 1.0)
ROOM_SIDE = 10.0  # m


def robot(kinematics: Kinematics = "differential") -> Robot:
    """Return a round robot of 0.2 m radius and 1 m/s with a 180-beam lidar of 8 m."""
    sideways = 1.0 if kinematics == "omnidirectional" else 0.0
    limits = VelocityLimits(-0.5, 1.0, sideways, 2.0, 2.0, 2.0 * sideways, 4.0)
    lidar = Lidar(180, -math.pi, 2.0 * math.pi / 180, 0.05, 8.0, 0.1, 0.0, Pose(0.0, 0.0, 0.0))
    car = kinematics == "ackermann"
    return Robot(
        "sample",
        kinematics,
        Footprint.circle(0.2),
        limits,
        lidar,
        OdometryModel(0.1, 0.0, 0.0, 0.0, 0.0),
        0.1,
        0.3 if car else 0.0,
        0.6 if car else 0.0,
    )


def room(side: float = ROOM_SIDE, resolution: float = 0.05) -> OccupancyGrid:
    """Return a square room, walled, its centre at the origin of ``map``."""
    return walled_room(side, resolution)


def scan(pose: Pose, body: Robot, side: float = ROOM_SIDE, resolution: float = 0.05, stamp: float = 0.0) -> LaserScan:
    """Return the exact scan of the walled room of ``room(side)`` from ``pose``."""
    lidar = body.lidar
    sensor = pose.compose(lidar.mount)
    angles = sensor.theta + lidar.angles()
    half = side / 2 - resolution
    with np.errstate(divide="ignore"):
        to_x = (np.copysign(half, np.cos(angles)) - sensor.x) / np.cos(angles)
        to_y = (np.copysign(half, np.sin(angles)) - sensor.y) / np.sin(angles)
    ranges = np.minimum(to_x, to_y).astype(np.float32)
    ranges[ranges > lidar.range_max] = np.inf
    return LaserScan(
        stamp, lidar.angle_min, lidar.angle_increment, lidar.range_min, lidar.range_max, ranges, lidar.mount
    )


def sensors(pose: Pose, body: Robot, stamp: float = 0.0, twist: Twist | None = None) -> Sensors:
    """Return what a robot measures in the walled room; its odometry has not drifted."""
    return Sensors(stamp, scan(pose, body, stamp=stamp), Odometry(stamp, pose, twist or Twist(0.0)), pose)


def straight_path(start: Pose, goal: Pose, spacing: float = 0.05) -> Path:
    """Return the straight path between two poses."""
    n = max(2, math.ceil(start.distance(goal) / spacing) + 1)
    heading = math.atan2(goal.y - start.y, goal.x - start.x)
    points = np.linspace((start.x, start.y), (goal.x, goal.y), n)
    return Path(np.column_stack((points, np.full(n, heading))))


def free_costmap(pose: Pose, side: float = 6.0, resolution: float = 0.05) -> Costmap:
    """Return a window around ``pose`` without any obstacle."""
    n = round(side / resolution)
    origin = np.round((np.array((pose.x, pose.y)) - side / 2) / resolution) * resolution
    return Costmap(np.zeros((n, n), np.uint8), np.full((n, n), np.inf, np.float32), resolution, origin)


def walled_costmap(pose: Pose, inscribed: float, side: float = 6.0) -> Costmap:
    """Return a window whose cells right around ``pose`` (0.4 m and beyond) are all lethal."""
    free = free_costmap(pose, side)
    index = (np.indices(free.costs.shape)[::-1].transpose(1, 2, 0) + 0.5) * free.resolution + free.origin_xy
    gap = np.maximum(0.4 - np.hypot(*(index - (pose.x, pose.y)).transpose(2, 0, 1)), 0.0).astype(np.float32)
    costs = np.where(gap == 0.0, LETHAL, np.where(gap <= inscribed, LETHAL - 1, 0)).astype(np.uint8)
    return Costmap(costs, gap, free.resolution, free.origin_xy)


def observation(
    pose: Pose | None = None,
    waypoint: Pose | None = None,
    goal: Pose | None = None,
    twist: Twist | None = None,
    body: Robot | None = None,
    costmap: Costmap | None = None,
    stamp: float = 0.0,
    tracks: Tracks = NO_TRACKS,
    *,
    known: bool = True,
) -> Observation:
    """Return what a planner sees in the walled room: by default at its centre, the goal 3 m
    ahead, the waypoint 2 m ahead.
    """
    body, pose = body or robot(), pose or Pose(0.0, 0.0, 0.0)
    goal = goal or Pose(pose.x + 3.0 * math.cos(pose.theta), pose.y + 3.0 * math.sin(pose.theta), pose.theta)
    waypoint = waypoint or Pose(pose.x + 2.0 * math.cos(pose.theta), pose.y + 2.0 * math.sin(pose.theta), pose.theta)
    window = costmap or free_costmap(pose)
    return make_observation(
        Sensors(stamp, scan(pose, body, stamp=stamp), Odometry(stamp, pose, twist or Twist(0.0))),
        PoseEstimate(pose, np.zeros((3, 3))),
        goal,
        waypoint,
        Path(freeze_array(straight_path(pose, goal).poses)),
        room() if known else None,
        lambda: window,
        lambda: tracks,
    )


WALKERS = ((2.0, 1.0, -0.5, 0.0), (1.0, -1.5, 0.0, 0.6), (-2.0, 0.5, 0.0, 0.0))  # x, y m, vx, vy m/s


def people(stamp: float) -> Tracks:
    """Return tracks of three people in the walled room, of whom two walk; ``stamp`` s after they began."""
    rows = [(x + stamp * vx, y + stamp * vy, vx, vy) for x, y, vx, vy in WALKERS]
    return tracked(*rows, variance=0.01)


def truth(body: Robot) -> Truth:
    """Return the truth of the walled room with these people."""
    return WorldTruth(*driven_room(body))


def driven_room(body: Robot) -> tuple[EpisodeLoop, int, Scenario]:
    """Return the walled room with these people in the planar simulator, its slot and its problem; raise
    UnknownComponent where that is not installed.
    """
    walkers = [person(k + 1, x, y, (x, y), (x + 4.0 * vx, y + 4.0 * vy)) for k, (x, y, vx, vy) in enumerate(WALKERS)]
    problem = scenario(start=Pose(0.0, 0.0), people=walkers)
    crowd = component("pedestrians", "social_force", ["pedestrians.reaction=ignore"])
    loop = EpisodeLoop(component("simulator", "sim2d", robot=body, pedestrians=crowd), body.control_period, 1, None)
    loop.begin([problem])
    return loop, 0, problem


def scenario(
    start: Pose | None = None,
    goal: Pose | None = None,
    people: Sequence[PedestrianSpec] = (),
    name: str = "sample/0",
    seed: int = 0,
) -> Scenario:
    """Return a drive through the walled room, 3 m straight ahead unless said, among ``people``."""
    return Scenario(
        name,
        seed,
        World("room", room()),
        start or Pose(-1.5, 0.0, 0.0),
        goal or Pose(1.5, 0.0, 0.0),
        tuple(people),
        (),
        0.3,
        60.0,
    )


def furniture(kind: str, x: float, y: float, theta: float = 0.0) -> Furniture:
    """Return a piece of furniture of conf/furniture."""
    return furniture_kind(kind).at(kind, Pose(x, y, theta))


def person(id: int, x: float, y: float, *waypoints: tuple[float, float], speed: float = 0.5) -> PedestrianSpec:
    """Return one person of 0.3 m radius who walks between ``waypoints``."""
    return PedestrianSpec(id, np.array((x, y)), np.array(waypoints, dtype=np.float64).reshape(-1, 2), speed, 0.3)


def record(steps: int = 31, *, contact: bool = False, leaves: bool = False) -> EpisodeRecord:
    """Return a record of a straight drive at 1 m/s past one standing person, who may leave
    half-way, made by the real recorder.
    """
    body, problem = robot(), scenario()
    columns = {"planner": "sample", "n_pedestrians": 1, "episode": 0, "seed": 0, "scenario": problem.name}
    meta = {"columns": columns, "world": {}, "config": {}}
    recorder = Recorder(problem, body, meta)
    states = [
        _world_state(k, contact=contact and k == steps // 2, absent=leaves and k > steps // 2) for k in range(steps)
    ]
    for k, state in enumerate(states[:-1]):
        estimate = PoseEstimate(state.pose, np.zeros((3, 3)))
        path = straight_path(problem.start, problem.goal) if k == 0 else None
        events = () if path is None else (Event(0.0, "replan", "start"),)
        decision = Decision(Twist(1.0), estimate, problem.goal, path, False, events, Spent(1e-3, 1e-3, 2e-3))
        recorder.sense(state, sensors(state.pose, body, state.stamp))
        recorder.add(decision)
    final = Decision(Twist(0.0), PoseEstimate(states[-1].pose, np.zeros((3, 3))), problem.goal, None, True, (), NO_TIME)
    return recorder.finish(states[-1], "goal_reached", "", final)


def component(
    kind: str, preset: str, overrides: Sequence[str] = (), robot_preset: str | None = None, **context: Any
) -> Any:
    """Build an installed component from its preset, alone; ``overrides`` are those of the command line."""
    chosen = [f"{kind}={preset}"] + ([f"robot={robot_preset}"] if robot_preset else [])
    registry = load_registry()
    config = _compose_words((*chosen, *overrides), registry)
    node = metric_packs(config).get(preset, {}) if kind == "metrics" else config.get(kind)
    if node is None:
        raise ConfigurationError(f"{kind}={preset} chooses no component; allowed: {', '.join(registry.names(kind))}")
    return registry.build(kind, node, **context)


def _compose_words(words: tuple[str, ...], registry: Registry) -> Any:
    """Return what these words compose, from what is kept unless there is a folder of
    one's own, whose files may change.
    """
    if own_folder() is not None:
        return to_plain(compose(words, config_name="component"))
    return deepcopy(_compose_cached(words, registry.manager))


@lru_cache(maxsize=256)
def _compose_cached(words: tuple[str, ...], _: PluginManager) -> Any:
    """Return what these words compose with the plugins of a manager: it takes longer than most
    of what a test does with it.
    """
    return to_plain(compose(words, config_name="component"))


def planner(preset: str, body: Robot, *overrides: str, robot_preset: str | None = None) -> Planner:
    """Build an installed planner for a robot and reset it for the walled room."""
    built: Planner = component("planner", preset, overrides, robot_preset, robot=body)
    built.reset(episode_start(body))
    return built


def episode_start(body: Robot, *, known: bool = True) -> EpisodeStart:
    """Return what a planner is told before an episode in the walled room."""
    return EpisodeStart(
        room() if known else None, Pose(3.0, 0.0), body.control_period, random_generator(0, "sample/0", "planner")
    )


def _world_state(k: int, *, contact: bool, absent: bool) -> WorldState:
    ids: NDArray[np.int32] = np.array((1,), np.int32)
    position: FloatArray = np.array(((np.nan, np.nan) if absent else (0.0, 1.0),))
    people = Pedestrians(ids, position, 0.0 * position, np.array((0.3,)), np.array((ABSENT if absent else 1,), np.int8))
    pose = Pose(-1.5 + 0.1 * k, 0.0, 0.0)
    clearance = math.inf if absent else math.hypot(pose.x, 1.0) - 0.5
    contacts = (Contact(0.1 * k, "person", 1, 1.0, True, pose.x, 0.0),) if contact else ()
    return WorldState(
        0.1 * k, pose, Twist(1.0), people, clearance, clearance, contact, 0.1 if contact else 0.0, contacts
    )


def views(body: Robot) -> list[Observation]:
    """Return what a robot sees at rest, driving, turning back, at its goal, in a walled room and in front of a wall."""
    walled = walled_costmap(Pose(0.0, 0.0, 0.0), body.footprint.inscribed_radius)
    return [
        observation(body=body),
        observation(body=body, twist=Twist(0.2, 0.0, 0.1), stamp=0.1),
        observation(body=body, waypoint=Pose(-2.0, 0.1), goal=Pose(-3.0, 0.1), stamp=0.2),
        observation(body=body, goal=Pose(0.05, 0.0), waypoint=Pose(0.05, 0.0), stamp=0.3),
        observation(body=body, costmap=walled, stamp=0.4),
        observation(body=body, pose=Pose(4.6, 0.0, 0.0), stamp=0.5),
    ]
