"""The actions of ``arena ros`` that need a ROS to talk to."""

from __future__ import annotations

import re
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import fields
from datetime import datetime
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

import numpy as np

from arena_core import ConfigurationError
from arena_core.commands import Words, read_words
from arena_core.hosting import Benchmark, OutsideRun, build_benchmark, compose, load_registry, to_plain
from arena_core.parameters import Count, Positive
from arena_ros.live.settings import Settings, live_settings
from arena_ros.pose_argument import read_pose
from arena_ros.transport import open_transport

if TYPE_CHECKING:
    from arena_ros.live.velocity_output import VelocityOutput

FIGURES = tuple(field.name for field in fields(Settings))
DRIVE_KEYS = (
    "transport",
    "namespace",
    "map",
    "goal",
    "start",
    "pose",
    "scan",
    "odometry",
    "cmd_vel",
    "alone",
    "action",
    "dry_run",
    "out",
    *FIGURES,
)
SIMULATE_KEYS = ("transport", "episode", "rate", "lock_step", "action", *FIGURES)


def drive_robot(usage: str, arguments: Sequence[str]) -> int:
    """Drive a robot; return 0 where every goal was reached, else 1."""
    from arena_ros.live.connections import Topics, connect_robot
    from arena_ros.live.driver import Driver, Site
    from arena_ros.live.sensor_inputs import SensorTopics
    from arena_ros.live.velocity_output import VelocityTopic

    words = read_words(usage, arguments, keys=DRIVE_KEYS, overrides=None)
    figures, pose, space = live_settings(words), words.value("pose", str, ""), _namespace(words)
    start, goal = read_pose(words, "start"), read_pose(words, "goal")
    where = ["world=ros_map", f"world.path={words.required('map')}"]
    config = compose([*where, *words.overrides, *(["localizer=ground_truth"] if pose else [])])
    registry = load_registry()
    benchmark = build_benchmark(config, registry)
    check_drivable(benchmark, "arena ros drive")
    benchmark.warm_up(tracks=True)
    world = registry.build("world", to_plain(config)["world"]).world(0, 0)
    folder = Path(words.value("out", str, f"outputs/{datetime.now():%Y-%m-%d/%H-%M-%S-%f}"))
    node = "arena_drive" + space.replace("/", "_")  # ROS 1 ends the first of two nodes of one name
    sensors = SensorTopics(
        words.value("scan", str, f"{space}/scan"), words.value("odometry", str, f"{space}/odom"), pose
    )
    target = words.value("cmd_vel", str, f"{space}/cmd_vel")
    if words.value("dry_run", bool, False):
        target = f"{space}/arena/dry_run/cmd_vel"
    with (
        note_signals() as why,
        closing(open_transport(words.value("transport", str, None), node)) as transport,
        OutsideRun(folder, benchmark.config, registry, benchmark.code) as run,
    ):
        velocities = VelocityTopic(target, words.value("alone", bool, True))
        topics = Topics(sensors, velocities, words.value("action", str, None), namespace=space)
        connections = connect_robot(transport, benchmark, figures, topics)
        driver = Driver(Site(benchmark, world, run), connections, why)
        driver.drive(start, goal)
        print_latency(connections.velocities, driver.wakes, benchmark.navigator.control_period)
    print(f"records: {folder}" if run.rows else "no records: there was no goal")
    return int(any(row["outcome"] != "goal_reached" for row in run.rows))


def _namespace(words: Words) -> str:
    """Return the namespace that the robot's topics are in, empty where they are in none; raise ConfigurationError."""
    said = words.value("namespace", str, "")
    if said and not re.fullmatch(r"/?[A-Za-z]\w*(/[A-Za-z]\w*)*", said, re.ASCII):
        raise ConfigurationError(f"namespace is {said}; allowed: a name of ROS, such as /robot1")
    return f"/{said.strip('/')}" if said else ""


def check_drivable(benchmark: Benchmark, command: str) -> None:
    """Raise ConfigurationError where something needs what no robot tells."""
    if benchmark.privileged:
        raise ConfigurationError(
            f"{' and '.join(benchmark.privileged)} would see the truth, which no real robot tells; allowed with "
            f"{command}: what sees sensors alone"
        )
    if benchmark.recording.live:
        raise ConfigurationError(
            f"recording.live is true; allowed with {command}: false, topics show a drive as it goes"
        )


def simulate_robot(usage: str, arguments: Sequence[str]) -> int:
    """Be a robot, or a team of robots."""
    from arena_ros.live.simulated_world import SimulatedWorld, robot_namespaces

    words = read_words(usage, arguments, keys=SIMULATE_KEYS, overrides=None)
    figures = live_settings(words)
    benchmark = build_benchmark(compose(words.overrides), load_registry())
    with (
        note_signals() as why,
        closing(open_transport(words.value("transport", str, None), "arena_simulate")) as transport,
    ):
        world = SimulatedWorld(transport, benchmark, figures.sensor_period, words.value("action", str, None))
        episode = words.value("episode", Count, 0)
        world.warm_up(episode)
        names = [name for name in robot_namespaces(benchmark.robots) if name]
        print(f"{', '.join(names) or 'the robot'} {'are' if names else 'is'} on the air", flush=True)
        world.run(
            episode,
            words.value("rate", Positive, 1.0),
            why,
            lock_step=words.value("lock_step", bool, False),
        )
    return 0


def run_watchdog(usage: str, arguments: Sequence[str]) -> int:
    """Relay velocities and stop the robot when they end."""
    from arena_ros.live.watchdog import relay_velocities

    words = read_words(usage, arguments, keys=("transport", "from", "to", *FIGURES))
    with (
        note_signals() as why,
        closing(open_transport(words.value("transport", str, None), "arena_watchdog")) as transport,
    ):
        print("watching", flush=True)
        relay_velocities(
            transport,
            words.value("from", str, "/arena/cmd_vel"),
            words.value("to", str, "/cmd_vel"),
            live_settings(words),
            lambda: bool(why()),
        )
    return 0


@contextmanager
def note_signals() -> Iterator[Callable[[], str]]:
    """Note Ctrl-C, SIGTERM and SIGHUP within the block: yield what says why it is to end, empty while it is not."""
    came: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        came.append(number)
        if len(came) > 1:  # a planner that hangs: the second signal takes it out of there
            raise KeyboardInterrupt

    # Windows has no SIGHUP
    numbers = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
    before = [signal.signal(number, note) for number in numbers]
    try:
        yield lambda: f"stopped by {signal.Signals(came[0]).name}" if came else ""
    finally:
        for number, usual in zip(numbers, before, strict=True):
            signal.signal(number, usual)


def print_latency(velocities: VelocityOutput, wakes: Sequence[float], period: float) -> None:
    """Print what control steps took, what of it was not the navigator's, and how evenly they
    came: median and p99 in ms.
    """
    if len(velocities.latencies) > 1:
        shown = {
            "took": velocities.latencies,
            "beyond the navigator": velocities.beyond,
            "jitter": np.abs(np.diff(wakes) - period),
        }
        figures = ((name, *np.percentile(1e3 * np.array(values), (50, 99))) for name, values in shown.items())
        print(
            f"control steps: {len(velocities.latencies)}; "
            + "; ".join(f"{name} {a:.2f} ms, p99 {b:.2f} ms" for name, a, b in figures)
        )
