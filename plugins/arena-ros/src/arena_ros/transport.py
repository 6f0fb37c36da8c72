"""Bytes from topic to topic: what a package for one generation of ROS implements, and nothing
else of it is needed here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import ClassVar

from arena_core import ConfigurationError
from arena_ros.action_protocol import EndCallback, GoalCallback, GoalSender
from arena_ros.codec import Ros

GROUP = "arena_ros"  # of entry points: a name such as ros1, and the class of a Transport
Publish = Callable[[bytes], None]
MessageCallback = Callable[[bytes], None]  # may be called in another thread
ACTIONS_BY = "allowed for actions of ROS 2: transport=ros2-rclpy"


class Transport(ABC):
    """One node. The constructor receives the node's name and raises ArenaError where there is no ROS to talk to."""

    ros: ClassVar[Ros]

    @abstractmethod
    def __init__(self, node: str) -> None: ...

    @abstractmethod
    def publisher(self, topic: str, type: str, *, latched: bool = False) -> Publish:
        """Return what publishes messages of a type; who comes later gets the last one of a latched topic."""

    @abstractmethod
    def subscribe(self, topic: str, type: str, heard: MessageCallback, *, latched: bool = False) -> None:
        """Have ``heard`` called with each message, of a latched topic also with what was sent before."""

    @abstractmethod
    def topics(self) -> Mapping[str, str]:
        """Return the topics that are published, with their types as far as they are known."""

    @abstractmethod
    def rivals(self, topic: str) -> list[str]:
        """Return who else publishes a topic; raise ArenaError where that cannot be said."""

    def serve(self, name: str, act: Callable[[], None]) -> bool:
        """Offer a service std_srvs/Empty; return whether this transport can."""
        return False

    def serve_action(self, name: str, type: str, heard: GoalCallback) -> None:
        """Offer an action of ROS 2, such as nav2_msgs/action/FollowPath: each goal is accepted, and ``heard``."""
        raise ConfigurationError(f"{name} cannot be served by {self.__class__.__name__}; {ACTIONS_BY}")

    def send_goals(self, name: str, type: str, heard: EndCallback) -> GoalSender:
        """Return what sends goals to an action of ROS 2; ``heard`` is called when something becomes of one."""
        raise ConfigurationError(f"{name} cannot be asked by {self.__class__.__name__}; {ACTIONS_BY}")

    @abstractmethod
    def close(self) -> None:
        """Leave; nothing is published any more."""


def open_transport(name: str | None, node: str) -> Transport:
    """Return a node on the transport of a name, on the only one whose ROS is installed where there is no name."""
    found = {point.name: point for point in entry_points(group=GROUP)}
    if name is None:
        # with a hyphen: a variant, taken only by name
        usual = [each for each in found if "-" not in each and _is_available(found[each])]
        name = usual[0] if len(usual) == 1 else None
    if name not in found:
        raise ConfigurationError(
            f"transport is {name or 'not said'}; allowed: {', '.join(sorted(found)) or 'none is installed'}"
        )
    transport: Callable[[str], Transport] = found[name].load()
    return transport(node)


def _is_available(point: EntryPoint) -> bool:
    """Return what the function ``available`` of a transport's module returns; true where it has none."""
    available: Callable[[], bool] | None = getattr(import_module(point.module), "available", None)
    return available is None or available()
