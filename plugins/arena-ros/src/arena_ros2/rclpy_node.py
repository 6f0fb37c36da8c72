"""Topics of ROS 2 by rclpy, whatever middleware it has; messages go through as bytes.

Their packages have to be installed.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any, ClassVar

from arena_core import ArenaError
from arena_core.commands import one_line, print_notice
from arena_ros.action_protocol import EndCallback, GoalCallback, GoalSender
from arena_ros.codec import Ros
from arena_ros.transport import MessageCallback, Publish, Transport
from arena_ros2.qos_settings import DEPTH, SENSORS
from arena_ros2.rclpy_actions import Sender, Server, interface_class

NEEDED = (
    "rclpy cannot be used ({}); allowed: a shell that has sourced a ROS 2 install, or transport=ros2-dds, "
    "which needs none"
)


class Rclpy(Transport):
    """A node of the graph that ROS_DOMAIN_ID and its like name; it shows in ``ros2 node list``."""

    ros: ClassVar[Ros] = 2

    def __init__(self, node: str) -> None:
        try:
            from rclpy.context import Context
            from rclpy.executors import SingleThreadedExecutor
            from rclpy.node import Node

            self._context = Context()
            self._context.init()
            self._node = Node(f"{node}_{os.getpid()}", context=self._context)
        except Exception as error:  # what a half installed ROS or a middleware raises
            raise ArenaError(NEEDED.format(one_line(f"{type(error).__name__}: {error}", 120))) from None
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)

        def spin() -> None:
            try:
                self._executor.spin()
            except Exception:  # as the context ends, any of several errors of rclpy
                if self._context.ok():
                    raise

        self._thread = threading.Thread(target=spin, daemon=True)
        self._thread.start()
        self._closed = False
        self._kept: list[Server] = []

    def publisher(self, topic: str, type: str, *, latched: bool = False) -> Publish:
        """Return what publishes, reliably; topics whose message package is not installed are left out, with a line."""
        try:
            publisher = self._node.create_publisher(
                interface_class(type), topic, _make_qos(reliable=True, latched=latched)
            )
        except ArenaError as error:
            print_notice(f"{error}; {topic} is not published")
            return lambda content: None

        def publish(content: bytes) -> None:
            if not self._closed:
                publisher.publish(content)

        return publish

    def subscribe(self, topic: str, type: str, heard: MessageCallback, *, latched: bool = False) -> None:
        """Hear a topic, in the node's thread; sensors also from publishers that are not reliable, as drivers are."""
        quality = _make_qos(reliable=latched or type not in SENSORS, latched=latched)
        self._node.create_subscription(interface_class(type), topic, heard, quality, raw=True)
        self._executor.wake()

    def topics(self) -> Mapping[str, str]:
        """Return what others publish, as far as it was discovered."""
        found = self._node.get_topic_names_and_types()
        return {topic: types[0] for topic, types in found if self.rivals(topic)}

    def rivals(self, topic: str) -> list[str]:
        """Return the other nodes that publish."""
        own = self._node.get_name()
        found = {
            (each.node_namespace.rstrip("/") + "/" + each.node_name)
            for each in self._node.get_publishers_info_by_topic(topic)
        }
        return sorted(name for name in found if name != f"/{own}")

    def serve(self, name: str, act: Callable[[], None]) -> bool:
        """Offer a service, where std_srvs is installed."""
        try:
            kind = import_module("std_srvs.srv").Empty
        except ImportError:
            return False

        def answer(request: Any, response: Any) -> Any:
            act()
            return response

        self._node.create_service(kind, name, answer)
        return True

    def serve_action(self, name: str, type: str, heard: GoalCallback) -> None:
        """Offer an action, where its package is installed."""
        self._kept.append(Server(self._node, self._executor, name, type, heard))
        self._executor.wake()

    def send_goals(self, name: str, type: str, heard: EndCallback) -> GoalSender:
        """Return what sends goals to an action, where its package is installed."""
        sender = Sender(self._node, self._executor, name, type, heard)
        self._executor.wake()
        return sender

    def close(self) -> None:
        """Leave the graph."""
        if self._closed:
            return
        self._closed = True
        self._executor.shutdown(1.0)
        self._thread.join(1.0)
        self._node.destroy_node()  # type: ignore[no-untyped-call, unused-ignore]
        self._context.try_shutdown()


def _make_qos(*, reliable: bool, latched: bool) -> Any:
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

    return QoSProfile(  # type: ignore[no-untyped-call, unused-ignore]
        depth=1 if latched else DEPTH,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )
