"""Measure `planner=ros_external` with a node that decides at once: how many times faster than real time episodes are,
all counted.

    python benchmarks/ros_lock_step.py [--transport ros2-dds] [--episodes 5]

The node is that of the tests, in another process, over DDS or at a ROS 1 master that is begun here.
"""

from __future__ import annotations

import argparse
import os
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from arena_core.hosting import Benchmark, build_benchmark, compose, load_registry
from arena_ros.testing import run_process, wait_until, world_overrides, write_site

PLUGINS = Path(__file__).resolve().parents[1] / "plugins"
ENDLESS = str(10**9)  # steps
DOMAIN = str(100 + os.getpid() % 100)
NODES = {
    "ros1": ["/usr/bin/python3", str(PLUGINS / "arena-ros/tests/ros1/follower.py"), ENDLESS],
    "ros2-dds": [sys.executable, str(PLUGINS / "arena-ros/tests/ros2/follower.py"), ENDLESS, DOMAIN],
}


@contextmanager
def open_network(transport: str) -> Iterator[None]:
    """Have something to meet on: a master on a free port, or a domain on this machine alone."""
    if transport != "ros1":
        os.environ |= {"ROS_DOMAIN_ID": DOMAIN, "ROS_LOCALHOST_ONLY": "1"}
        yield
        return
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    os.environ |= {"ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_IP": "127.0.0.1"}
    with run_process("/usr/bin/rosmaster", "--core", "-p", str(port)):
        wait_until(lambda: not socket.socket().connect_ex(("127.0.0.1", port)), 20.0)
        yield


def print_pace(name: str, benchmark: Benchmark, episodes: int, folder: Path) -> None:
    """Print the pace of some episodes, and where their time went; the first one, in which all is
    compiled, does not count.
    """
    benchmark.run(0, folder)
    simulated, planner, navigator = 0.0, list[float](), list[float]()
    begin, used = time.perf_counter(), time.process_time()
    for episode in range(1, episodes + 1):
        record = benchmark.run(episode, folder)
        simulated += float(record["stamp"][-1])
        planner += record.timing["planner_seconds"].tolist()
        navigator += record.timing["navigator_seconds"].tolist()
    wall, cpu, steps = time.perf_counter() - begin, time.process_time() - used, len(planner)
    step, here, rest = (1e3 * each / steps for each in (wall, cpu, wall - sum(navigator)))
    medians = (
        f"node and wire {1e3 * np.median(planner):.2f} ms, all of the navigator {1e3 * np.median(navigator):.2f} ms"
    )
    print(f"{name}: {simulated / wall:.0f} times real time; {steps} steps of {step:.2f} ms, of CPU here {here:.2f} ms")
    print(f"  medians: {medians}; mean of simulation and record {rest:.2f} ms", flush=True)


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--transport", choices=sorted(NODES), default="ros2-dds")
    parser.add_argument("--episodes", type=int, default=5)
    chosen = parser.parse_args()
    with (
        TemporaryDirectory() as folder,
        open_network(chosen.transport),
        run_process(*NODES[chosen.transport], log=Path(folder) / "node.txt"),
    ):
        site, registry = write_site(Path(folder)), load_registry()
        words = ["planner=ros_external", f"planner.transport={chosen.transport}", "executor=serial"]
        places = {
            "a room": world_overrides(site),
            "the warehouse among ten people": ["robot=jackal", "world=warehouse", "task=random", "task.pedestrians=10"],
        }
        for name, place in places.items():
            print_pace(
                name, build_benchmark(compose([*words, *place]), registry), chosen.episodes, Path(folder) / "run"
            )
    print(f"load {os.getloadavg()[0]:.1f}, {os.cpu_count()} hyperthreads")


if __name__ == "__main__":
    main()
