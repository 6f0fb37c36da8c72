"""A domain of its own, on this machine alone, and who stands by there."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.register_assert_rewrite("arena_ros.testing")

from arena_ros.testing import FakeRobot, RobotProbe, write_site  # noqa: E402 - after what rewrites it
from arena_ros2.dds import Dds  # noqa: E402

# what a driver does whatever carries its messages: every check has it over ROS 1; what makes a robot stand stays
OF_ANY_TRANSPORT = (
    "test_a_dry_run_moves_nothing",
    "test_a_planner_that_hangs_leaves_a_robot_that_stands",
    "test_a_pose_from_elsewhere_counts_as_true",
    "test_a_pose_in_a_foreign_frame_is_one_line",
    "test_stamps_that_jump_by_an_hour_change_nothing",
    "test_what_is_missing_or_of_another_type_is_one_line",
)


def pytest_itemcollected(item: pytest.Item) -> None:
    """Leave that to `make long`."""
    if item.path.name in ("test_ros2.py", "test_faults.py") and item.name in OF_ANY_TRANSPORT:
        item.add_marker(pytest.mark.long)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A room, and a problem in it."""
    return write_site(tmp_path_factory.mktemp("site"))


@pytest.fixture(scope="module")
def air() -> Iterator[None]:
    """A domain of its own."""
    before = dict(os.environ)
    os.environ |= {"ROS_DOMAIN_ID": str(100 + os.getpid() % 100), "ROS_LOCALHOST_ONLY": "1"}
    yield
    os.environ.clear()
    os.environ |= before


@pytest.fixture(scope="module")
def wheels_of_ros2() -> Iterator[None]:
    """A domain of its own, on this machine alone; processes that are started find the wheels of
    ROS 2, this one does not.
    """
    before, wheels = dict(os.environ), Path(sys.prefix) / "ros2"
    packages = wheels / "lib" / f"python{sys.version_info.major}.{sys.version_info.minor}" / "site-packages"
    libraries = [wheels / "lib", *wheels.glob("*.libs")]
    os.environ |= {"ROS_DOMAIN_ID": str(100 + os.getpid() % 100), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    os.environ |= {"PYTHONPATH": f"{packages}:{wheels}", "LD_LIBRARY_PATH": ":".join(map(str, libraries))}
    yield
    os.environ.clear()
    os.environ |= before


@pytest.fixture(scope="module")
def node(air: None) -> Iterator[Dds]:
    """A participant of that domain."""
    found = Dds("bystander")
    yield found
    found.close()


@pytest.fixture(scope="module")
def listener(node: Dds) -> RobotProbe:
    """Who listens all the time."""
    return RobotProbe(node)


@pytest.fixture
def probe(listener: RobotProbe) -> RobotProbe:
    """What is heard of a simulated robot, from now on."""
    listener.forget()
    return listener


@pytest.fixture(scope="module")
def puppet(node: Dds) -> FakeRobot:
    """A robot that drives as long as its block lasts."""
    return FakeRobot(node)
