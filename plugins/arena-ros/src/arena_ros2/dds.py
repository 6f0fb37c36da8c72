"""Topics of ROS 2 over DDS (Cyclone DDS); messages go through as the bytes that a node of ROS 2 sends."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from functools import lru_cache
from typing import Any, ClassVar

from arena_core import ArenaError
from arena_core.commands import one_line
from arena_core.hosting import require_extra
from arena_ros.codec import Ros
from arena_ros.transport import MessageCallback, Publish, Transport
from arena_ros2.qos_settings import DEPTH, SENSORS

LOOPBACK = (  # as the middlewares of ROS 2 do it: unicast between the ports of the first 32 participants, no multicast
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface "
    "address='127.0.0.1'/></Interfaces><AllowMulticast>false</AllowMulticast>"
    "</General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    "<Peers><Peer address='127.0.0.1'/></Peers></Discovery></Domain></CycloneDDS>"
)
LAST_DOMAIN = 232
MOST_WRITERS = 10_000  # of a domain that are looked through


class Dds(Transport):
    """A participant of the domain that ROS_DOMAIN_ID names; ROS_LOCALHOST_ONLY=1 keeps to this machine."""

    ros: ClassVar[Ros] = 2

    def __init__(self, node: str) -> None:
        require_extra("DDS", ["cyclonedds"], "arena-ros[ros2]")
        from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
        from cyclonedds.core import DDSException, InstanceState, ReadCondition, SampleState, ViewState
        from cyclonedds.domain import DomainParticipant
        from cyclonedds.pub import Publisher
        from cyclonedds.sub import Subscriber

        number = _domain_id()
        local = (
            os.environ.get("ROS_LOCALHOST_ONLY") == "1"
            or os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE") == "LOCALHOST"
        )
        try:
            if local:
                _on_loopback(number)
            self._participant = DomainParticipant(number)
            self._writers = BuiltinDataReader(self._participant, BuiltinTopicDcpsPublication)
            self._alive = ReadCondition(self._writers, InstanceState.Alive | SampleState.Any | ViewState.Any)
            self._publisher, self._subscriber = Publisher(self._participant), Subscriber(self._participant)
        except DDSException as error:
            raise ArenaError(f"DDS domain {number} cannot be joined ({one_line(str(error), 80)})") from None
        self._kept: list[Any] = []
        self._out: list[Any] = []
        self._closed = False

    def publisher(self, topic: str, type: str, *, latched: bool = False) -> Publish:
        """Return what publishes, reliably."""
        from cyclonedds.core import DDSException
        from cyclonedds.pub import DataWriter
        from cyclonedds.topic import Topic

        from arena_ros2.types import make_sample, sample_type

        kind = sample_type(type)
        writer = DataWriter(
            self._publisher, Topic(self._participant, f"rt{topic}", kind), qos=_make_qos(reliable=True, latched=latched)
        )
        number = len(self._out)
        self._out.append(writer)
        del writer  # only this object keeps it, so that it leaves the domain when this is closed

        def publish(content: bytes) -> None:
            if not self._closed:
                # a reader that does not keep up holds a reliable writer for 100 ms at most
                with suppress(DDSException, IndexError):
                    self._out[number].write(make_sample(kind, content))

        return publish

    def subscribe(self, topic: str, type: str, heard: MessageCallback, *, latched: bool = False) -> None:
        """Hear a topic, in a thread of DDS; sensors also from writers that are not reliable, as drivers are."""
        from cyclonedds.core import Listener
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic

        from arena_ros2.types import sample_type

        class Ear(Listener):
            def on_data_available(self, reader: Any) -> None:
                for one in reader.take(N=DEPTH):
                    if hasattr(one, "content"):  # else a person has left
                        heard(one.content)

        kind = sample_type(type)
        ear: Any = Ear()  # type: ignore[no-untyped-call]
        about = Topic(self._participant, f"rt{topic}", kind)
        self._kept += [
            ear,
            DataReader(
                self._subscriber,
                about,
                qos=_make_qos(reliable=latched or type not in SENSORS, latched=latched),
                listener=ear,
            ),
        ]

    def topics(self) -> Mapping[str, str]:
        """Return what is published in the domain, as far as it was discovered."""
        from arena_ros2.types import ros_name

        return {
            found.topic_name[2:]: ros_name(found.type_name)
            for found in self._other_writers()
            if found.topic_name.startswith("rt/")
        }

    def rivals(self, topic: str) -> list[str]:
        """Return the participants that also publish; DDS knows no names of nodes."""
        return sorted(
            {
                f"participant {found.participant_key}"
                for found in self._other_writers()
                if found.topic_name == f"rt{topic}"
            }
        )

    def _other_writers(self) -> list[Any]:
        """Return the writers of others that are there now."""
        own = str(self._participant.guid)
        found = self._writers.read(N=MOST_WRITERS, condition=self._alive)
        return [each for each in found if hasattr(each, "topic_name") and str(each.participant_key) != own]

    def close(self) -> None:
        """Leave the domain."""
        if self._closed:
            return
        self._closed = True
        self._kept.clear()
        self._out.clear()
        for name in ("_publisher", "_subscriber", "_alive", "_writers", "_participant"):
            delattr(self, name)


@lru_cache
def _on_loopback(number: int) -> Any:
    """Keep a domain to this machine, once in a process: DDS takes no second configuration."""
    from cyclonedds.domain import Domain

    return Domain(number, LOOPBACK)


def _domain_id() -> int:
    text = os.environ.get("ROS_DOMAIN_ID") or "0"
    if not text.isdecimal() or int(text) > LAST_DOMAIN:
        raise ArenaError(f"ROS_DOMAIN_ID is {one_line(text, 40)}; allowed: 0 .. {LAST_DOMAIN}")
    return int(text)


def _make_qos(*, reliable: bool, latched: bool) -> Any:
    from cyclonedds.core import Policy, Qos
    from cyclonedds.util import duration

    reliability = Policy.Reliability.Reliable(duration(milliseconds=100)) if reliable else Policy.Reliability.BestEffort
    durability = Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile
    return Qos(reliability, durability, Policy.History.KeepLast(1 if latched else DEPTH))
