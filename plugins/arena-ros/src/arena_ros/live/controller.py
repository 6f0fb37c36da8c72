"""``arena ros controller``: a planner of the suite in the place of Nav2's controller_server."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import fields
from datetime import datetime
from pathlib import Path

from arena_core import ArenaError, World
from arena_core.commands import Words, read_words
from arena_core.hosting import Benchmark, OutsideRun, build_benchmark, compose, load_registry, to_plain
from arena_ros import conversions as to
from arena_ros.codec import get_codec
from arena_ros.live.commands import FIGURES, check_drivable, note_signals, print_latency
from arena_ros.live.connections import Topics, connect_robot
from arena_ros.live.driver import Driver, Site
from arena_ros.live.latest_message import LatestMessage
from arena_ros.live.path_goals import Checkers, PathGoals, PluginNames
from arena_ros.live.sensor_inputs import SensorTopics
from arena_ros.live.settings import Settings, live_settings, read_figures
from arena_ros.live.time_source import RosTime
from arena_ros.live.velocity_output import VelocityTopic
from arena_ros.pose_argument import read_pose
from arena_ros.transport import Transport, open_transport

PLUGINS = {  # names of nav2_bringup's nav2_params.yaml, and Nav2's own defaults
    "controllers": "FollowPath",
    "goal_checkers": "general_goal_checker,goal_checker",
    "progress_checkers": "progress_checker",
}
KEYS = (
    "transport",
    "map",
    "start",
    "pose",
    "scan",
    "odometry",
    "cmd_vel",
    "alone",
    "action",
    "stamped",
    "use_sim_time",
    "out",
    *PLUGINS,
    *FIGURES,
    *(field.name for field in fields(Checkers)),
)
VIEWS = {"/plan": "/received_global_plan", "/arena/local_costmap": "/local_costmap/costmap"}  # as in Nav2
IDLE = 0.02  # s


def serve_controller(usage: str, arguments: Sequence[str]) -> int:
    """Follow the paths that come until a signal; return 0."""
    words = read_words(usage, arguments, keys=KEYS, overrides=None)
    figures, checkers = live_settings(words), read_figures(words, "controller.yaml", Checkers)
    pose = words.value("pose", str, "none" if "start" in words.keys else "/tf").replace("none", "")
    file = words.value("map", str, None)
    where = ["world=ros_map", f"world.path={file}"] if file else ["world=empty"]
    config = compose([*where, *words.overrides, *(["localizer=ground_truth"] if pose else [])])
    registry = load_registry()
    benchmark = build_benchmark(config, registry)
    check_drivable(benchmark, "arena ros controller")
    benchmark.warm_up(tracks=True)  # a path whose robot stands for a compiler is given up
    folder = Path(words.value("out", str, f"outputs/{datetime.now():%Y-%m-%d/%H-%M-%S-%f}"))
    with (
        note_signals() as why,
        closing(open_transport(words.value("transport", str, None), "arena_controller")) as transport,
        OutsideRun(folder, benchmark.config, registry, benchmark.code) as run,
    ):
        topics = _topics(words, transport, benchmark, checkers, pose)
        connections = connect_robot(transport, benchmark, figures, topics)
        assert isinstance(topics.goals, PathGoals)
        topics.goals.odom = connections.sensors.odom_frame
        print("following paths", flush=True)
        if file:
            world = registry.build("world", to_plain(config)["world"]).world(0, 0)
        else:
            world = _world_on_air(transport, figures, why)
        driver = Driver(Site(benchmark, world, run), connections, why)
        driver.drive(read_pose(words, "start"), None)
        if topics.clock is None:  # a clock that stands while others think measures nothing
            print_latency(connections.velocities, driver.wakes, benchmark.navigator.control_period)
    print(f"records: {folder}" if run.rows else "no records: there was no path")
    return 0


def _topics(words: Words, transport: Transport, benchmark: Benchmark, checkers: Checkers, pose: str) -> Topics:
    """Return the topics, with the action among them: it takes goals from now on."""
    stamped = words.value("stamped", bool, False)
    clock = RosTime(transport) if stamped or words.value("use_sim_time", bool, False) else None
    velocities = VelocityTopic(
        words.value("cmd_vel", str, "/cmd_vel"),
        words.value("alone", bool, False),
        idle=False,
        clock=clock if stamped else None,
    )
    sensors = SensorTopics(words.value("scan", str, "/scan"), words.value("odometry", str, "/odom"), pose)
    names = PluginNames(*(words.value(key, str, usual).split(",") for key, usual in PLUGINS.items()))
    action = words.value("action", str, "/follow_path")
    goals = PathGoals(transport, action, names, checkers, benchmark.navigator)
    return Topics(sensors, velocities, None, goals, clock, VIEWS)


def _world_on_air(transport: Transport, figures: Settings, is_over: Callable[[], str]) -> World:
    """Return the map of ``/map``; raise ArenaError where there is none."""
    heard = LatestMessage(transport, get_codec(transport.ros), "/map", to.GRID, latched=True)
    end = time.monotonic() + figures.patience
    while (message := heard.take()) is None:
        if is_over():
            raise KeyboardInterrupt
        if time.monotonic() > end:
            raise ArenaError(
                f"no map on /map within {figures.patience:g} s; allowed: map=MAP.yaml, or patience=SECONDS"
            )
        time.sleep(IDLE)
    return World("map", to.grid_from_msg(message))
