"""What all recordings have in common: channels, and messages one after the other."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from arena_ros.codec import Ros

LARGEST_CHUNK = 2**28  # bytes of what is unpacked at a time; recorders write 1 to 4 MB
LARGEST_RECORD = 2**28  # bytes


@dataclass(frozen=True, slots=True)
class Channel:
    """One topic of a recording with its type as ROS 2 names it, and that type's definition where the recording has it."""

    topic: str
    type: str
    definition: str


class Cut(Exception):
    """A recording ends early, or is damaged from here on; what came before is good."""


class Bag(ABC):
    """A recording. ``cut`` says, after all messages were read, why it ended early; empty where it did not."""

    ros: ClassVar[Ros]

    def __init__(self, path: Path) -> None:
        self.path = path
        self.cut = ""

    @abstractmethod
    def channels(self) -> dict[Channel, int]:
        """Return the channels with the number of their messages (1 where only reading it all would tell)."""

    @abstractmethod
    def read(self, topics: Collection[str]) -> Iterator[tuple[Channel, int, bytes]]:
        """Yield channel, time of recording in ns and content of each message of these topics; raise Cut where it ends early."""

    def messages(self, topics: Collection[str]) -> Iterator[tuple[Channel, int, bytes]]:
        """Yield channel, time of recording in ns and content of each message of these topics, as far as there are any."""
        try:
            yield from self.read(topics)
        except Cut as cut:
            self.cut = str(cut)


def normalised(name: str) -> str:
    """Return a type as ROS 2 names it: ``sensor_msgs/msg/LaserScan``."""
    package, _, own = name.partition("/")
    return name if own.startswith(("msg/", "srv/", "action/")) else f"{package}/msg/{own}"
