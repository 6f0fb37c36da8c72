"""What all recordings have in common: channels, and messages one after the other."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from arena_core import InputFileError
from arena_ros.codec import Ros

LARGEST_CHUNK = 2**28  # bytes of what is unpacked at a time; recorders write 1 to 4 MB
LARGEST_RECORD = 2**28  # bytes
KINDS = ".bag, .mcap, .db3, or the folder of a ROS 2 bag"


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


def open_bags(paths: Collection[Path]) -> list[Bag]:
    """Return recordings by their endings; raise InputFileError for what is none."""
    found = [bag for path in paths for bag in _open(path)]
    if len({bag.ros for bag in found}) > 1:
        raise InputFileError(f"{found[0].path}: is of ROS {found[0].ros}, others are not; allowed: recordings of one generation")
    return found


def _open(path: Path) -> list[Bag]:
    from arena_ros.bags.db3 import Db3
    from arena_ros.bags.mcap import Mcap
    from arena_ros.bags.ros1 import Ros1Bag

    kinds: dict[str, type[Bag]] = {".bag": Ros1Bag, ".active": Ros1Bag, ".mcap": Mcap, ".db3": Db3}
    if path.is_dir():
        inside = sorted(each for each in path.iterdir() if each.suffix in (".mcap", ".db3"))
        if not inside:
            raise InputFileError(f"{path}: holds no recording; allowed: {KINDS}")
        return [kinds[each.suffix](each) for each in inside]
    if path.suffix not in kinds:
        raise InputFileError(f"{path}: is no recording by its name; allowed: {KINDS}")
    if not path.is_file():
        raise InputFileError(f"{path}: no such file; allowed: {KINDS}")
    return [kinds[path.suffix](path)]


def normalised(name: str) -> str:
    """Return a type as ROS 2 names it: ``sensor_msgs/msg/LaserScan``."""
    package, _, own = name.partition("/")
    return name if own.startswith(("msg/", "srv/", "action/")) else f"{package}/msg/{own}"
