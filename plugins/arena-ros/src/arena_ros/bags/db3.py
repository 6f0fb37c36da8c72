"""Recordings of ROS 2 in SQLite (rosbag2_storage_sqlite3)."""

from __future__ import annotations

import sqlite3
from collections.abc import Collection, Iterator
from contextlib import closing
from typing import ClassVar

from arena_core import InputFileError, one_line
from arena_ros.bags.stream import LARGEST_RECORD, Bag, Channel, Cut, normalised
from arena_ros.codec import Ros

MAGIC = b"SQLite format 3\0"
DAMAGED = (sqlite3.Error, TypeError, ValueError)  # what the module raises for a damaged file, names that are no text among it


class Db3(Bag):
    """A ``.db3``."""

    ros: ClassVar[Ros] = 2

    def channels(self) -> dict[Channel, int]:
        """Return the channels with the numbers of their messages."""
        with closing(self._open()) as database:
            try:
                known = self._known(database)
                counts = dict(database.execute("SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id"))
            except DAMAGED as error:
                known, counts = self._known_or_refuse(database, error), {}
        found: dict[Channel, int] = {}
        for number, channel in known.items():
            found[channel] = found.get(channel, 0) + (counts.get(number, 0) if counts else 1)
        return found

    def read(self, topics: Collection[str]) -> Iterator[tuple[Channel, int, bytes]]:
        """Yield the messages of these topics, of all where there are none; raise Cut where the file is damaged."""
        with closing(self._open()) as database:
            try:
                known = {number: channel for number, channel in self._known(database).items() if not topics or channel.topic in topics}
                wanted = ",".join("?" * len(known))
                query = f"SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN ({wanted}) ORDER BY timestamp"  # noqa: S608 - marks
                for number, stamp, data in database.execute(query, tuple(known)):
                    yield known[number], int(stamp), bytes(data)
            except DAMAGED as error:
                raise Cut(f"the data base is damaged ({one_line(str(error), 80)})") from None

    def _open(self) -> sqlite3.Connection:
        with self.path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                raise InputFileError(f"{self.path}: is no SQLite file; allowed: what `ros2 bag record -s sqlite3` wrote")
        database = sqlite3.connect(f"{self.path.resolve().as_uri()}?mode=ro&immutable=1", uri=True)
        database.text_factory = lambda content: content.decode(errors="replace")
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST_RECORD)
        return database

    def _known(self, database: sqlite3.Connection) -> dict[int, Channel]:
        definitions: dict[str, str] = {}
        if database.execute("SELECT 1 FROM sqlite_master WHERE name = 'message_definitions'").fetchone():
            rows = database.execute("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions")
            definitions = {str(name): str(text) for name, encoding, text in rows if encoding == "ros2msg"}
        rows = database.execute("SELECT id, name, type FROM topics")
        return {int(n): Channel(str(topic), normalised(str(name)), definitions.get(str(name), "")) for n, topic, name in rows}

    def _known_or_refuse(self, database: sqlite3.Connection, error: Exception) -> dict[int, Channel]:
        try:
            return self._known(database)
        except DAMAGED:
            raise InputFileError(
                f"{self.path}: cannot be read ({one_line(str(error), 80)}); allowed: what `ros2 bag record -s sqlite3` wrote"
            ) from None
