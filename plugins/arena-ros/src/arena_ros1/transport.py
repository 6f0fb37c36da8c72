"""Topics of ROS 1 by rospy; messages go through as bytes, so that none of ROS's message packages is needed."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from threading import Lock
from typing import Any, ClassVar

from arena_core import ArenaError
from arena_core.commands import one_line
from arena_ros.codec import Ros, get_codec
from arena_ros.transport import MessageCallback, Publish, Transport

DEBIAN = "/usr/lib/python3/dist-packages"  # appended, so that packages of the environment at hand come first
NEEDED = (
    "rospy is not installed; allowed: apt install python3-rospy (Debian, the same Python), "
    "or a shell that has sourced a ROS 1 install"
)


def available() -> bool:
    """Return whether rospy is installed, or lies where Debian puts it."""
    return find_spec("rospy") is not None or (Path(DEBIAN) / "rospy").is_dir()


class Ros1(Transport):
    """A node at the master that ROS_MASTER_URI names."""

    ros: ClassVar[Ros] = 1

    def __init__(self, node: str) -> None:
        self._rospy = _import_rospy()
        master = _connect_master()
        try:
            master.getPid()
        except Exception as error:  # whatever a socket or XML-RPC raises
            raise ArenaError(
                f"no ROS master at {master.master_uri} ({one_line(str(error), 60)}); allowed: "
                "start roscore or rosmaster"
            ) from None
        self._master, self._asking = master, Lock()
        self._closed = False
        try:
            self._rospy.init_node(node, anonymous=True, disable_signals=True, disable_rosout=True)
        except Exception as error:
            raise ArenaError(f"the node {node} cannot begin ({one_line(str(error), 80)})") from None

    def publisher(self, topic: str, type: str, *, latched: bool = False) -> Publish:
        """Return what publishes."""
        kind = self._message_type(type)
        publisher = self._rospy.Publisher(topic, kind, latch=latched, queue_size=10, tcp_nodelay=True)

        def publish(content: bytes) -> None:
            if self._closed:
                return
            message = kind()
            message._buff = content  # noqa: SLF001 - the field in which rospy.AnyMsg hands bytes on; there is no other
            with suppress(self._rospy.ROSException):  # the master, or all of ROS, is gone
                publisher.publish(message)

        return publish

    def subscribe(self, topic: str, type: str, heard: MessageCallback, *, latched: bool = False) -> None:
        """Hear a topic, in rospy's thread."""

        def read(message: Any) -> None:
            heard(message._buff)  # noqa: SLF001 - as above

        self._rospy.Subscriber(topic, self._message_type(type), read, queue_size=10, tcp_nodelay=True)

    def topics(self) -> Mapping[str, str]:
        """Return what is published at the master."""
        published = self._ask_master(lambda master: master.getPublishedTopics(""))
        return {topic: "/msg/".join(kind.split("/")) for topic, kind in published}

    def rivals(self, topic: str) -> list[str]:
        """Return who else publishes, as the master knows."""
        publishers = dict(self._ask_master(lambda master: master.getSystemState()[0])).get(topic, [])
        return sorted(name for name in publishers if name != self._rospy.get_name())

    def _ask_master(self, ask: Callable[[Any], Any]) -> Any:
        """Return what the master answers; one thread asks at a time, as a connection holds one request."""
        try:
            with self._asking:
                return ask(self._master)
        except Exception as error:
            raise ArenaError(f"the ROS master does not answer any more ({one_line(str(error), 60)})") from None

    def serve(self, name: str, act: Callable[[], None]) -> bool:
        """Offer a service, where std_srvs is installed."""
        try:
            from std_srvs.srv import Empty, EmptyResponse
        except ImportError:
            return False

        def answer(request: Any) -> Any:
            act()
            return EmptyResponse()

        self._rospy.Service(name, Empty, answer)
        return True

    def close(self) -> None:
        """Leave the master."""
        if not self._closed:
            self._closed = True
            self._rospy.signal_shutdown("done")

    def _message_type(self, name: str) -> type[Any]:
        """Return a type of rospy's whose messages are the bytes themselves."""
        text, digest = get_codec(1).definition(name)
        short = name.replace("/msg/", "/")
        fields = {
            "_type": short,
            "_md5sum": digest,
            "_full_text": text,
            "serialize": _serialize,
            "__slots__": ["_buff"],
        }
        return type(short.rpartition("/")[2], (self._rospy.AnyMsg,), fields)


def _serialize(message: Any, buffer: Any) -> None:
    buffer.write(message._buff)  # noqa: SLF001 - as above


def _import_rospy() -> Any:
    try:
        import rospy
    except ImportError:
        if not (Path(DEBIAN) / "rospy").is_dir():
            raise ArenaError(NEEDED) from None
        if DEBIAN not in sys.path:
            sys.path.append(DEBIAN)
        try:
            import rospy
        except ImportError as error:
            raise ArenaError(f"{NEEDED} ({one_line(str(error), 80)})") from None
    return rospy


def _connect_master() -> Any:
    import rosgraph

    try:
        return rosgraph.Master("/arena")
    except Exception as error:
        raise ArenaError(f"ROS_MASTER_URI is of no use ({one_line(str(error), 80)})") from None
