"""The usual transport of ROS 2: rclpy where a ROS 2 install or its wheels bring it, else DDS."""

from __future__ import annotations

from importlib.util import find_spec

from arena_ros.transport import Transport


def available() -> bool:
    """Return whether rclpy or DDS is installed."""
    return any(find_spec(module) is not None for module in ("rclpy", "cyclonedds"))


def ros2(node: str) -> Transport:
    """Return a node by rclpy where it can be imported, else one that speaks DDS itself."""
    if find_spec("rclpy") is not None:
        from arena_ros2.rclpy_node import Rclpy

        return Rclpy(node)
    from arena_ros2.dds import Dds

    return Dds(node)
