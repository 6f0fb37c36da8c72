"""One master and one node for all tests: rospy allows a process no second one."""

from __future__ import annotations

import os
import socket
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.register_assert_rewrite("arena_ros.testing")

# after what rewrites it
from arena_ros.testing import FakeRobot, RobotProbe, run_process, wait_until, write_site  # noqa: E402
from arena_ros1.transport import Ros1  # noqa: E402


def pytest_configure(config: pytest.Config) -> None:
    """Let rospy leave sockets to be collected: that is no fault of ours."""
    if config.option.markexpr == "ros1":
        config.addinivalue_line("filterwarnings", "ignore::pytest.PytestUnraisableExceptionWarning")


@pytest.hookimpl(tryfirst=True)
def pytest_unconfigure(config: pytest.Config) -> None:
    """Let it do so after the last test, too, when the settings above count no more."""
    if config.option.markexpr == "ros1":
        warnings.filterwarnings("ignore", category=pytest.PytestUnraisableExceptionWarning)


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A room, and a problem in it."""
    return write_site(tmp_path_factory.mktemp("site"))


@pytest.fixture(scope="session")
def air() -> Iterator[None]:
    """A master of its own on a free port."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    before = dict(os.environ)
    os.environ |= {"ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_IP": "127.0.0.1"}
    with run_process("/usr/bin/rosmaster", "--core", "-p", str(port)):
        wait_until(lambda: not socket.socket().connect_ex(("127.0.0.1", port)), 20.0)
        yield
    os.environ.clear()
    os.environ |= before


@pytest.fixture(scope="session")
def node(air: None) -> Iterator[Ros1]:
    """A node at that master."""
    found = Ros1("bystander")
    yield found
    found.close()


@pytest.fixture(scope="session")
def listener(node: Ros1) -> RobotProbe:
    """Who listens all the time."""
    return RobotProbe(node)


@pytest.fixture
def probe(listener: RobotProbe) -> RobotProbe:
    """What is heard of a simulated robot, from now on."""
    listener.forget()
    return listener


@pytest.fixture(scope="session")
def puppet(node: Ros1) -> FakeRobot:
    """A robot that drives as long as its block lasts."""
    return FakeRobot(node)
