"""Actions of ROS 2 by rclpy: all that touches it runs in its executor's thread, so nothing is called twice at once.

Fields that the installed interface lacks are left out, those that only it has keep their defaults: so one code serves
several releases of nav2_msgs.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

from arena_core import ArenaError
from arena_ros.action_protocol import EndCallback, GoalCallback, GoalSender, GoalStatus, ReceivedGoal
from arena_ros.codec import get_codec

MESSAGE = "/msg/"


def interface_class(name: str) -> Any:
    """Return a message's or an action's class; raise ArenaError where its package is not installed."""
    package, kind, own = name.split("/")
    try:
        return getattr(import_module(f"{package}.{kind}"), own)
    except (ImportError, AttributeError):
        raise ArenaError(f"rclpy knows no {name}: {package} is not installed") from None


def native_message(kind: Any, message: Any) -> Any:
    """Return a message of rclpy's class ``kind`` with the fields of one of our codec."""
    from rclpy.serialization import deserialize_message

    made, codec = kind(), get_codec(2)
    for field in kind.get_fields_and_field_types():
        if hasattr(message, field):
            value = getattr(message, field)
            name = getattr(value, "__msgtype__", "")
            setattr(
                made, field, deserialize_message(codec.encode(value, name), interface_class(name)) if name else value
            )
    return made


class _Received(ReceivedGoal):
    """A goal of rclpy's action server; ``done`` is what its execution waits for."""

    def __init__(self, executor: Any, handle: Any, done: Any) -> None:
        self.request = handle.request
        self._executor, self._handle, self._done = executor, handle, done

    @property
    def is_cancelled(self) -> bool:
        return bool(self._handle.is_cancel_requested)

    def publish_feedback(self, message: Any) -> None:
        self._executor.create_task(lambda: self._handle.publish_feedback(native_message(_part_class(message), message)))

    def end(self, status: GoalStatus, result: Any) -> None:
        def finish() -> None:
            ways = {GoalStatus.SUCCEEDED: self._handle.succeed, GoalStatus.CANCELED: self._handle.canceled}
            if self._handle.is_active:
                ways.get(status, self._handle.abort)()
            self._done.set_result(native_message(_part_class(result), result))

        self._executor.create_task(finish)


def _part_class(message: Any) -> Any:
    """Return rclpy's class of a part of an action, such as nav2_msgs/action/FollowPath_Result."""
    action, _, part = message.__msgtype__.rpartition("_")
    return getattr(interface_class(action), part)


class Server:
    """Serves one action of a node."""

    def __init__(self, node: Any, executor: Any, name: str, type: str, heard: GoalCallback) -> None:
        from rclpy.action import ActionServer, CancelResponse
        from rclpy.task import Future

        waiting: dict[bytes, Any] = {}

        def accept(handle: Any) -> None:
            done = waiting[bytes(handle.goal_id.uuid)] = Future(executor=executor)
            handle.execute()
            heard(_Received(executor, handle, done))

        async def execute(handle: Any) -> Any:
            return await waiting.pop(bytes(handle.goal_id.uuid))

        self.server = ActionServer(
            node,
            interface_class(type),
            name,
            execute,
            handle_accepted_callback=accept,
            cancel_callback=lambda handle: CancelResponse.ACCEPT,
        )


class Sender(GoalSender):
    """Sends goals to one action; answers to an older goal than the last are left out."""

    def __init__(self, node: Any, executor: Any, name: str, type: str, heard: EndCallback) -> None:
        from rclpy.action import ActionClient

        self._executor, self._heard, self._action = executor, heard, interface_class(type)
        self._client = ActionClient(node, self._action, name)
        self._handle: Any = None
        self._count = 0

    def is_served(self) -> bool:
        """Return whether there is a server."""
        return bool(self._client.server_is_ready())

    def send(self, goal: Any) -> None:
        """Send a goal; the one before counts no more."""
        self._count += 1
        self._handle, self.is_known, self.ended = None, False, None
        number = self._count

        def begin() -> None:
            sent = self._client.send_goal_async(native_message(self._action.Goal, goal))
            sent.add_done_callback(lambda future: self._on_answer(number, future.result()))

        self._executor.create_task(begin)

    def cancel(self) -> None:
        """Say that the goal is not wanted any more."""
        handle = self._handle
        if handle is not None and self.ended is None:
            self._executor.create_task(handle.cancel_goal_async)

    def _on_answer(self, number: int, handle: Any) -> None:
        if number != self._count:
            return
        if not handle.accepted:
            self.ended = GoalStatus.UNKNOWN, None
        else:
            self._handle, self.is_known = handle, True
            handle.get_result_async().add_done_callback(lambda future: self._on_result(number, future.result()))
        self._heard()

    def _on_result(self, number: int, response: Any) -> None:
        if number == self._count:
            self.ended = GoalStatus(response.status), response.result
            self._heard()
