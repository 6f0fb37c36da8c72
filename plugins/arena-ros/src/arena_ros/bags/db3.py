"""Recordings of ROS 2 in SQLite (rosbag2_storage_sqlite3)."""

from __future__ import annotations

import sqlite3
from collections.abc import Collection, Iterator
from contextlib import closing
from pathlib import Path

from arena_core import InputFileError
from arena_core.commands import one_line
from arena_ros.bags.decompression import UnpackLimit
from arena_ros.bags.repeats import Repeats
from arena_ros.bags.stream import LARGEST_MESSAGE, Bag, Channel, Message, TruncatedBag, ros2_type_name

MAGIC = b"SQLite format 3\0"
WROTE = "what `ros2 bag record -s sqlite3` wrote"
# what the module raises for a damaged file, names that are no text too
DAMAGED = (sqlite3.Error, TypeError, ValueError, OverflowError)
COLUMNS = {"topics": ("id", "name", "type"), "messages": ("id", "topic_id", "timestamp", "data")}


class Db3(Bag):
    """A ``.db3``."""

    def __init__(self, path: Path, name: Path | None = None) -> None:
        super().__init__(path, name)
        self._again: Collection[int] | None = None

    def channels(self) -> dict[Channel, int]:
        """Return the channels with the numbers of their messages."""
        with closing(self._open_database()) as database:
            try:
                known = _known_channels(database)
                counts = dict(database.execute("SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id"))
            except DAMAGED as error:
                known, counts = self._read_channels(database, error), {}
        found: dict[Channel, int] = {}
        for number, channel in known.items():
            found[channel] = found.get(channel, 0) + (counts.get(number, 0) if counts else 1)
        return found

    def read(self, topics: Collection[str], *, in_time: bool) -> Iterator[Message]:
        """Yield the messages of these topics, of all where there are none; raise Cut where the file is damaged."""
        allowance = UnpackLimit(self.path)
        with closing(self._open_database()) as database:
            try:
                known = {
                    number: channel
                    for number, channel in _known_channels(database).items()
                    if not topics or channel.topic in topics
                }
                wanted = ",".join("?" * len(known))
                order = "timestamp, id" if in_time else "id"
                columns = "id, topic_id, timestamp, length(data)"
                # ``wanted`` are question marks
                query = f"SELECT {columns} FROM messages WHERE topic_id IN ({wanted}) ORDER BY {order}"  # noqa: S608
                again = self._repeated_rows(database)
                for row, number, stamp, size in database.execute(query, tuple(known)):
                    if row not in again:
                        yield known[number], int(stamp), allowance.message(_content_of(database, row, size))
            except DAMAGED as error:
                raise TruncatedBag(f"the data base is damaged ({one_line(str(error), 80)})") from None

    def _repeated_rows(self, database: sqlite3.Connection) -> Collection[int]:
        """Return the rows of messages that stand there again; all is read for that only where there may be any."""
        if self._again is None:
            channels, found, repeats = _known_channels(database), set[int](), Repeats()
            if _may_repeat(database):
                query = "SELECT id, topic_id, timestamp, length(data) FROM messages ORDER BY timestamp, id"
                for row, number, stamp, size in database.execute(query):
                    content = _content_of(database, row, size)
                    if number in channels and repeats.holds(channels[number], int(number), int(stamp), content):
                        found.add(row)
            self._again, self.repeated = found, len(found)
        return self._again

    def _open_database(self) -> sqlite3.Connection:
        with self.path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                raise InputFileError(f"{self.name}: is no SQLite file; allowed: {WROTE}")
        database = sqlite3.connect(f"{self.path.resolve().as_uri()}?mode=ro&immutable=1", uri=True)
        database.text_factory = lambda content: content.decode(errors="replace")
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST_MESSAGE)
        try:
            database.execute("PRAGMA trusted_schema = OFF")
            wrong = next(
                (name for name, columns in COLUMNS.items() if not _is_plain_table(database, name, columns)), None
            )
        except DAMAGED as error:
            database.close()
            raise InputFileError(
                f"{self.name}: cannot be read ({one_line(str(error), 80)}); allowed: {WROTE}"
            ) from None
        if wrong is not None:
            database.close()
            raise InputFileError(f"{self.name}: {wrong} is no table as recorders write it; allowed: {WROTE}")
        return database

    def _read_channels(self, database: sqlite3.Connection, error: Exception) -> dict[int, Channel]:
        try:
            return _known_channels(database)
        except DAMAGED:
            raise InputFileError(
                f"{self.name}: cannot be read ({one_line(str(error), 80)}); allowed: {WROTE}"
            ) from None


def _content_of(database: sqlite3.Connection, row: int, size: int | None) -> bytes:
    """Return the content of a message, nothing where there is none or too much."""
    if size is None or size > LARGEST_MESSAGE:
        return b""
    return bytes(database.execute("SELECT data FROM messages WHERE id = ?", (row,)).fetchone()[0])


def _may_repeat(database: sqlite3.Connection) -> bool:
    """Return whether a topic has two writers, or two messages of one time."""
    questions = (
        "SELECT 1 FROM topics GROUP BY name HAVING COUNT(*) > 1 LIMIT 1",
        "SELECT 1 FROM messages GROUP BY topic_id, timestamp HAVING COUNT(*) > 1 LIMIT 1",
    )
    return any(database.execute(question).fetchone() is not None for question in questions)


def _is_plain_table(database: sqlite3.Connection, name: str, columns: tuple[str, ...]) -> bool:
    """Return whether rows lie in the file: views, virtual tables and generated columns compute
    them, for as long as they like.
    """
    row = database.execute("SELECT type, rootpage FROM sqlite_master WHERE name = ?", (name,)).fetchall()
    if [(kind, bool(page)) for kind, page in row] != [("table", True)]:
        return False
    stored = {
        column: (kind, key)
        for _, column, kind, _, _, key, hidden in database.execute(f"PRAGMA table_xinfo({name})")
        if not hidden
    }
    return stored.keys() >= set(columns) and (str(stored["id"][0]).upper(), stored["id"][1]) == ("INTEGER", 1)


def _known_channels(database: sqlite3.Connection) -> dict[int, Channel]:
    rows = database.execute("SELECT id, name, type FROM topics")
    return {int(number): Channel(str(topic), ros2_type_name(str(name)), 2) for number, topic, name in rows}
