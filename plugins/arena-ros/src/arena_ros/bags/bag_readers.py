"""Which reader a recording needs, by its name."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from arena_core import InputFileError
from arena_ros.bags.db3 import Db3
from arena_ros.bags.decompression import ENDINGS, unpack_file
from arena_ros.bags.mcap import Mcap
from arena_ros.bags.ros1 import Ros1Bag
from arena_ros.bags.stream import Bag

KINDS = ".bag, .mcap, .db3, the folder of a ROS 2 bag, any of these compressed, or .csv files of Arena-Bench's recorder"
READERS: dict[str, type[Bag]] = {".bag": Ros1Bag, ".active": Ros1Bag, ".mcap": Mcap, ".db3": Db3}


@contextmanager
def open_bags(paths: Collection[Path]) -> Iterator[list[Bag]]:
    """Lend recordings by their endings, unpacked where they are compressed; raise InputFileError for what is none."""
    files = [file for path in paths for file in _bag_files(path)]
    with ExitStack() as stack:
        yield [_open_bag(path, stack) for path in files]


def _open_bag(path: Path, stack: ExitStack) -> Bag:
    if path.suffix not in ENDINGS:
        return READERS[path.suffix](path)
    return READERS[path.with_suffix("").suffix](stack.enter_context(unpack_file(path)), path)


def _bag_kind(path: Path) -> str:
    """Return the ending that says which reader a file needs, without that of a compression."""
    return path.with_suffix("").suffix if path.suffix in ENDINGS else path.suffix


def _bag_files(path: Path) -> list[Path]:
    if path.is_dir():
        inside = sorted(each for each in path.iterdir() if _bag_kind(each) in (".mcap", ".db3") and each.is_file())
        names = {each.name for each in inside}
        inside = [each for each in inside if each.suffix not in ENDINGS or each.with_suffix("").name not in names]
        if not inside:
            raise InputFileError(f"{path}: holds no recording; allowed: {KINDS}")
        return inside
    if _bag_kind(path) not in READERS:
        raise InputFileError(f"{path}: is no recording by its name; allowed: {KINDS}")
    if not path.is_file():
        raise InputFileError(f"{path}: no such file; allowed: {KINDS}")
    return [path]
