"""What all recordings have in common: channels, and messages one after the other in the order of time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from heapq import heappop, heappush
from pathlib import Path

from arena_ros.codec import Ros

LARGEST_CHUNK = 2**27  # bytes of what is unpacked at a time; recorders write 1 to 4 MB
LARGEST_RECORD = 2**27  # bytes
LARGEST_MESSAGE = 2**26  # bytes of one message that is read; a picture without compression has 2**25
LARGEST_OVERLAP = 2**27  # bytes of messages that wait for earlier ones
MOST_PIECES = 300_000  # of one file; recorders make 130,000 in 100 GB
OVERHEAD = 200  # bytes that a waiting message takes beside its content
OLD_NAMES = {"tf/msg/tfMessage": "tf2_msgs/msg/TFMessage"}  # ROS 1 before 2013; the same bytes


@dataclass(frozen=True, slots=True)
class Channel:
    """One topic of a recording with its type as ROS 2 names it, and how its messages are written."""

    topic: str
    type: str
    ros: Ros


Message = tuple[Channel, int, bytes]  # channel, time of recording in ns, content


class TruncatedBag(Exception):
    """A recording ends early, or is damaged from here on; what came before is good."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of a file: when its first message was recorded, ns, and how to read its messages."""

    first: int
    read: Callable[[], Iterable[Message]]


class Bag(ABC):
    """A recording. ``cut`` says, after all messages were read, why it ended early; empty where it did not.
    ``repeated`` counts the messages that it holds again, each of which was read once.

    ``name`` is the file as its user knows it, ``path`` the one that is read, an unpacked copy of it perhaps.
    """

    def __init__(self, path: Path, name: Path | None = None) -> None:
        self.path, self.name = path, name or path
        self.cut = ""
        self.repeated = 0

    @abstractmethod
    def channels(self) -> dict[Channel, int]:
        """Return the channels with the number of their messages (1 where only reading it all would tell)."""

    @abstractmethod
    def read(self, topics: Collection[str], *, in_time: bool) -> Iterator[Message]:
        """Yield the messages of these topics, by time of recording or as they lie in the file;
        raise Cut where it ends early.
        """

    def messages(self, topics: Collection[str], *, in_time: bool = True) -> Iterator[Message]:
        """Yield the messages of these topics, of all where there are none, as far as there are any."""
        try:
            yield from self.read(topics, in_time=in_time)
        except TruncatedBag as cut:
            self.cut = str(cut)

    def count_messages(self) -> dict[Channel, int]:
        """Return the channels by reading all of the file."""
        found: dict[Channel, int] = {}
        try:
            for channel, _, _ in self.read((), in_time=False):
                found[channel] = found.get(channel, 0) + 1
        except TruncatedBag as cut:
            self.cut = str(cut)
        return found


def by_time(pieces: Iterable[Piece]) -> Iterator[Message]:
    """Yield the messages of pieces by time of recording, equal times as they lie in the file.

    Only pieces that lie over one another in time are in memory together; raises Cut where these are too much.
    """
    waiting: list[tuple[int, int, int, Channel, bytes]] = []
    held = 0
    for number, piece in enumerate(sorted(pieces, key=lambda each: each.first)):
        while waiting and waiting[0][0] < piece.first:
            stamp, _, _, channel, content = heappop(waiting)
            held -= len(content) + OVERHEAD
            yield channel, stamp, content
        try:
            for place, (channel, stamp, content) in enumerate(piece.read()):
                heappush(waiting, (stamp, number, place, channel, content))
                held += len(content) + OVERHEAD
                if held > LARGEST_OVERLAP:
                    raise TruncatedBag(f"more than {LARGEST_OVERLAP // 10**6} MB of it are not in the order of time")
        except TruncatedBag as cut:
            yield from _drain_heap(waiting)
            raise cut from None
    yield from _drain_heap(waiting)


def _drain_heap(waiting: list[tuple[int, int, int, Channel, bytes]]) -> Iterator[Message]:
    while waiting:
        stamp, _, _, channel, content = heappop(waiting)
        yield channel, stamp, content


def ros2_type_name(name: str) -> str:
    """Return a type as ROS 2 names it: ``sensor_msgs/msg/LaserScan``."""
    package, _, own = name.partition("/")
    full = name if own.startswith(("msg/", "srv/", "action/")) else f"{package}/msg/{own}"
    return OLD_NAMES.get(full, full)
