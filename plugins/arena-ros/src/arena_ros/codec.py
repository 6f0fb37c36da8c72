"""Messages of ROS 1 and ROS 2 as bytes and back, without ROS: the same for bags and for the wire."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from importlib.resources import files
from typing import Any, Literal

from arena_core import ArenaError
from arena_core.commands import one_line

Ros = Literal[1, 2]
PEOPLE = "people_msgs/msg/People"
DEFINITIONS = {  # of packages that rosbags does not bring for both: tf2_msgs, and people_msgs of wg-perception, 1.4
    "tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms\n",
    "people_msgs/msg/Person": "string name\ngeometry_msgs/Point position\ngeometry_msgs/Point "
    "velocity\nfloat64 reliability\n"
    "string[] tagnames\nstring[] tags\n",
    PEOPLE: "std_msgs/Header header\npeople_msgs/Person[] people\n",
}
MOVE_BASE = {  # of ROS 1 alone: move_base_msgs 1.14
    "move_base_msgs/msg/MoveBaseGoal": "geometry_msgs/PoseStamped target_pose\n",
    "move_base_msgs/msg/MoveBaseFeedback": "geometry_msgs/PoseStamped base_position\n",
    "move_base_msgs/msg/MoveBaseResult": "",
    "move_base_msgs/msg/MoveBaseActionGoal": "std_msgs/Header header\nactionlib_msgs/GoalID "
    "goal_id\nmove_base_msgs/MoveBaseGoal goal\n",
    "move_base_msgs/msg/MoveBaseActionFeedback": "std_msgs/Header header\nactionlib_msgs/GoalStatus status\n"
    "move_base_msgs/MoveBaseFeedback feedback\n",
    "move_base_msgs/msg/MoveBaseActionResult": "std_msgs/Header header\nactionlib_msgs/GoalStatus status\n"
    "move_base_msgs/MoveBaseResult result\n",
}
ACTION_PARTS = ("Goal", "Result", "Feedback")  # of an .action file, in its order


class BadMessage(ArenaError):
    """A message cannot be read."""


class Codec:
    """Makes, writes and reads messages of one generation of ROS; types are named as in ROS 2,
    ``sensor_msgs/msg/LaserScan``.
    """

    def __init__(self, ros: Ros) -> None:
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore

        self.ros = ros
        self.store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
        found: dict[str, Any] = {}
        for name, text in (DEFINITIONS | (MOVE_BASE if ros == 1 else dict(action_definitions()))).items():
            found.update(get_types_from_msg(text, name))
        own = {name: value for name, value in found.items() if name not in self.store.fielddefs}
        self.store.register(own)

    def make(self, name: str, /, **fields: Any) -> Any:
        """Return a message of a type with these fields, all of them."""
        return self.store.types[name](**fields)

    def encode(self, message: Any, name: str) -> bytes:
        """Return a message as it stands on the wire and in bags."""
        return bytes(
            self.store.serialize_ros1(message, name) if self.ros == 1 else self.store.serialize_cdr(message, name)
        )

    def decode(self, content: bytes, name: str) -> Any:
        """Return the message; raise BadMessage where the bytes are none of this type."""
        try:
            return (
                self.store.deserialize_ros1(content, name)
                if self.ros == 1
                else self.store.deserialize_cdr(content, name)
            )
        except Exception as error:  # whatever the decoder stumbles over
            raise BadMessage(f"a message is no {name} ({one_line(f'{type(error).__name__}: {error}', 80)})") from None

    def has_type(self, name: str) -> bool:
        """Return whether a type is known."""
        return name in self.store.fielddefs

    def constants(self, name: str) -> dict[str, int]:
        """Return the constants of a type."""
        return {key: int(value) for key, _, value in self.store.fielddefs[name][0]}

    def definition(self, name: str) -> tuple[str, str]:
        """Return the text of a type's definition, with all that it holds, and its MD5 sum, as ROS 1 has them."""
        text, digest = self.store.generate_msgdef(name, ros_version=self.ros)
        return text, digest

    def time(self, stamp: int) -> Any:
        """Return a stamp of ns as a message."""
        return self.make("builtin_interfaces/msg/Time", sec=stamp // 10**9, nanosec=stamp % 10**9)

    def header(self, stamp: int, frame: str) -> Any:
        """Return a header with a stamp of ns."""
        own = {"seq": 0} if self.ros == 1 else {}
        return self.make("std_msgs/msg/Header", stamp=self.time(stamp), frame_id=frame, **own)


def action_definitions() -> Iterator[tuple[str, str]]:
    """Yield the names and texts of the messages of Nav2's actions, as nav2_msgs of Jazzy has them."""
    folder = files("arena_ros") / "interfaces" / "nav2_msgs" / "action"
    for file in folder.iterdir():
        for part, text in zip(ACTION_PARTS, file.read_text(encoding="utf-8").split("---\n"), strict=True):
            yield f"nav2_msgs/action/{file.name.removesuffix('.action')}_{part}", text


@lru_cache(maxsize=2)
def get_codec(ros: Ros) -> Codec:
    """Return the codec of a generation of ROS."""
    return Codec(ros)


def stamp_of(time: Any) -> int:
    """Return the ns of a time message."""
    return int(time.sec) * 10**9 + int(time.nanosec)
