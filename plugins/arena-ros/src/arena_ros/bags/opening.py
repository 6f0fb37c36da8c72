"""Which reader a recording needs, by its name."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from arena_core import InputFileError
from arena_ros.bags.db3 import Db3
from arena_ros.bags.mcap import Mcap
from arena_ros.bags.ros1 import Ros1Bag
from arena_ros.bags.stream import Bag

KINDS = ".bag, .mcap, .db3, the folder of a ROS 2 bag, or .csv files of Arena-Bench's recorder"


def open_bags(paths: Collection[Path]) -> list[Bag]:
    """Return recordings by their endings; raise InputFileError for what is none."""
    found = [bag for path in paths for bag in _open(path)]
    if len({bag.ros for bag in found}) > 1:
        raise InputFileError(f"{found[0].path}: is of ROS {found[0].ros}, others are not; allowed: recordings of one generation")
    return found


def _open(path: Path) -> list[Bag]:
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
