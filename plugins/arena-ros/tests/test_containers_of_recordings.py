"""Recordings in other containers, compressed, damaged, or made to take all memory."""

from __future__ import annotations

import bz2
import gzip
import lzma
import sqlite3
import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import lz4.frame
import numpy as np
import pytest

from arena_core.cli.main import main
from arena_core.commands import print_notice
from arena_ros.bags import mcap, stream
from arena_ros.bags.bag_readers import open_bags
from arena_ros.bags.decompression import zstd
from arena_ros.codec import get_codec
from arena_ros.testing.synthetic_recording import (
    assert_baseline,
    drive_messages,
    goal_message,
    import_recording,
    in_order,
    path_length,
    write_recording,
)

STRANGERS = Path(__file__).parents[4] / "shared" / "data" / "strangers" / "bags"
MEGABYTES, SECONDS = 600.0, 30.0  # of an import, process and all, on a busy machine
TOPICS = (
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, "
    "offered_qos_profiles TEXT)"
)
MESSAGES = "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)"
ODOMETRY = "INSERT INTO topics VALUES(1, '/odom', 'nav_msgs/msg/Odometry', 'cdr', '')"
ENDLESS = "WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c) SELECT x AS id"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_recording(tmp_path_factory.mktemp("whole") / "a.db3", in_order([*drive_messages(), *goal_message()]))


PACKED: dict[str, Callable[[bytes], bytes]] = {
    "zstd": zstd.compress,
    "zst": zstd.compress,
    "lz4": lz4.frame.compress,
    "gz": gzip.compress,
    "bz2": bz2.compress,
    "xz": lzma.compress,
}


@pytest.mark.parametrize("ending", PACKED)
def test_recording_that_is_compressed_as_a_whole_is_read(whole: Path, tmp_path: Path, ending: str) -> None:
    packed = tmp_path / f"a.db3.{ending}"
    packed.write_bytes(PACKED[ending](whole.read_bytes()))
    (record,) = import_recording(packed, tmp_path / "out")
    assert_baseline(record)


def repacked(whole: Path, target: Path, pack: Callable[[int, bytes], bytes]) -> Path:
    """Copy a data base with other messages."""
    target.write_bytes(whole.read_bytes())
    with sqlite3.connect(target) as database:
        rows = database.execute("SELECT id, data FROM messages").fetchall()
        database.executemany(
            "UPDATE messages SET data = ? WHERE id = ?", [(pack(number, data), number) for number, data in rows]
        )
    return target


def doubled(whole: Path, target: Path, *, writers: bool) -> int:
    """Copy a data base with each message twice: rows, or those of a second writer 3 ms later; return how many."""
    target.write_bytes(whole.read_bytes())
    with sqlite3.connect(target) as database:
        if writers:
            rest = "name, type, serialization_format, offered_qos_profiles, type_description_hash"
            database.execute(f"INSERT INTO topics(id, {rest}) SELECT id + 1000, {rest} FROM topics")
        shift = (1000, 3_000_000) if writers else (0, 0)
        copied = "SELECT topic_id + ?, timestamp + ?, data FROM messages"
        return database.execute(f"INSERT INTO messages(topic_id, timestamp, data) {copied}", shift).rowcount


@pytest.mark.parametrize("writers", [False, True], ids=["rows", "writers"])
def test_message_that_stands_there_twice_counts_once_and_that_is_said(
    whole: Path, tmp_path: Path, writers: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    (alone,) = import_recording(whole, tmp_path / "alone")
    capsys.readouterr()
    count = doubled(whole, tmp_path / "a.db3", writers=writers)
    (record,) = import_recording(tmp_path / "a.db3", tmp_path / "out")
    assert_baseline(record)
    assert f"a.db3: {count} messages stand there twice; each counts once" in capsys.readouterr().err
    for name, values in alone.arrays.items():
        np.testing.assert_array_equal(record[name], values)


@pytest.mark.parametrize("pack", [zstd.compress, lz4.frame.compress], ids=["zstd", "lz4"])
def test_messages_that_are_compressed_each_are_read(
    whole: Path, tmp_path: Path, pack: Callable[[bytes], bytes]
) -> None:
    (record,) = import_recording(repacked(whole, tmp_path / "a.db3", lambda _, data: pack(data)), tmp_path / "out")
    assert_baseline(record)


@pytest.mark.parametrize(
    ("spoilt", "said"),
    [
        (b"\x28\xb5\x2f\xfd\0\0\0", "left out"),
        (zstd.compress(bytes(80_000_000)), "it unpacks to more than 200 times its size"),
    ],
    ids=["damaged", "of 80 MB"],
)
def test_messages_that_cannot_be_unpacked_are_said(
    whole: Path, tmp_path: Path, spoilt: bytes, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = repacked(whole, tmp_path / "a.db3", lambda number, data: spoilt if number % 50 == 7 else data)
    assert len(import_recording(bag, tmp_path / "out")) == 1
    assert said in capsys.readouterr().err


def test_chunks_of_an_mcap_may_lie_in_any_order(tmp_path: Path) -> None:
    chunks, head = list[bytes](), b""
    data = write_recording(tmp_path / "a.mcap", in_order([*drive_messages(), *goal_message()])).read_bytes()
    at = len(mcap.MAGIC)
    while data[at] != mcap.DATA_END:
        end = at + 9 + struct.unpack_from("<Q", data, at + 1)[0]
        if data[at] == mcap.MESSAGE:
            chunks.append(data[at:end])
        elif data[at] in (mcap.SCHEMA, mcap.CHANNEL):
            head += data[at:end]
        elif data[at] == mcap.CHUNK:
            size = struct.unpack_from("<I", data, at + 9 + 28)[0]
            inner, place = data[at + 9 + 32 + size + 8 : end], 0
            assert size == 0
            while place < len(inner):
                last = place + 9 + struct.unpack_from("<Q", inner, place + 1)[0]
                if inner[place] == mcap.MESSAGE:
                    chunks.append(inner[place:last])
                elif inner[place] in (mcap.SCHEMA, mcap.CHANNEL):
                    head += inner[place:last]
                place = last
        at = end
    parts = [b"".join(chunks[k : k + 40]) for k in range(0, len(chunks), 40)]
    packed = b"".join(
        chunk(parts[k], kind)
        for k, kind in zip([*range(1, len(parts)), 0], ["zstd", "lz4", ""] * len(parts), strict=False)
    )
    (tmp_path / "b.mcap").write_bytes(mcap.MAGIC + head + packed + record(mcap.DATA_END, bytes(4)))
    (imported_record,) = import_recording(tmp_path / "b.mcap", tmp_path / "out")
    assert_baseline(imported_record)


def record(kind: int, content: bytes) -> bytes:
    return struct.pack("<BQ", kind, len(content)) + content


def text(content: str | bytes) -> bytes:
    encoded = content if isinstance(content, bytes) else content.encode()
    return struct.pack("<I", len(encoded)) + encoded


def chunk(content: bytes, compression: str) -> bytes:
    packed = {"zstd": zstd.compress, "lz4": lz4.frame.compress, "": bytes}[compression](content)
    stamps = [struct.unpack_from("<Q", content, at + 15)[0] for at in message_places(content)] or [0]
    head = struct.pack("<QQQI", min(stamps), max(stamps), len(content), 0)
    return record(mcap.CHUNK, head + text(compression) + struct.pack("<Q", len(packed)) + packed)


def message_places(content: bytes) -> list[int]:
    places, at = [], 0
    while at < len(content) and content[at] == mcap.MESSAGE:
        places.append(at)
        at += 9 + struct.unpack_from("<Q", content, at + 1)[0]
    return places


def one_topic(
    name: str, definition: str | bytes = "", encoding: str = "cdr", schema_encoding: str = "ros2msg"
) -> bytes:
    schema = record(mcap.SCHEMA, struct.pack("<H", 1) + text(name) + text(schema_encoding) + text(definition))
    return (
        mcap.MAGIC
        + schema
        + record(mcap.CHANNEL, struct.pack("<HH", 1, 1) + text("/odom") + text(encoding) + text(b""))
    )


def data_base(path: Path, *statements: str) -> Path:
    with sqlite3.connect(path) as database:
        for statement in statements:
            database.execute(statement)
    return path


def message(stamp: int, content: bytes) -> bytes:
    return record(mcap.MESSAGE, struct.pack("<HIQQ", 1, 0, stamp, stamp) + content)


def write_bomb(kind: str, folder: Path) -> Path:
    """Write a file that is made to take all time or memory."""
    views = {
        "endless messages": (
            TOPICS,
            ODOMETRY,
            f"CREATE VIEW messages AS {ENDLESS}, 1 AS topic_id, x AS timestamp, x'00' AS data FROM c",
        ),
        "endless topics": (
            MESSAGES,
            f"CREATE VIEW topics AS {ENDLESS}, '/odom' AS name, 'nav_msgs/msg/Odometry' AS type FROM c",
        ),
        "endless definitions": (TOPICS, ODOMETRY, MESSAGES, f"CREATE VIEW message_definitions AS {ENDLESS} FROM c"),
        "zeroblob": (
            TOPICS,
            ODOMETRY,
            "CREATE VIEW messages AS SELECT 1 AS id, 1 AS topic_id, 5 AS timestamp, zeroblob(1900000000) AS data",
        ),
        "stored zeroblob": (TOPICS, ODOMETRY, MESSAGES, "INSERT INTO messages VALUES(1, 1, 5, zeroblob(200000000))"),
        "generated": (
            TOPICS,
            ODOMETRY,
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data BLOB AS (zeroblob(200000000)))",
            "INSERT INTO messages(id, topic_id, timestamp) VALUES(1, 1, 5)",
        ),
    }
    if kind in views:
        return data_base(folder / "a.db3", *views[kind])
    if kind == "packed file":
        (folder / "a.mcap.zstd").write_bytes(zstd.compress(bytes(300_000_000)))
        return folder / "a.mcap.zstd"
    big = (
        chunk(b"".join(message(k, bytes(1_000_000)) for k in range(110)), "zstd")
        if kind == "chunks"
        else chunk(bytes(120_000_000), "zstd")
    )
    (folder / "a.mcap").write_bytes(one_topic("nav_msgs/msg/Odometry") + big * 40 + record(mcap.DATA_END, bytes(4)))
    return folder / "a.mcap"


BOMBS = (
    "endless messages",
    "endless topics",
    "endless definitions",
    "zeroblob",
    "stored zeroblob",
    "generated",
    "packed file",
    "chunks",
    "chunks of nothing",
)
APART = """
import re, sys
from pathlib import Path
from arena_core.cli.main import main
status = main(["ros", "import", sys.argv[1], "--out", sys.argv[2], "robot=turtlebot3"])
# the peak of this program alone: getrusage begins with the memory of the program that started it
peak = Path("/proc/self/status")
print(status, int(re.search(r"VmHWM:\\s+(\\d+) kB", peak.read_text())[1]) / 1e3 if peak.is_file() else 0.0)
"""


@pytest.mark.parametrize("kind", BOMBS)
def test_what_is_made_to_take_all_memory_ends_soon(tmp_path: Path, kind: str) -> None:
    words = [sys.executable, "-c", APART, str(write_bomb(kind, tmp_path)), str(tmp_path / "out")]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=SECONDS, check=True)
    status, megabytes = ended.stdout.split()[-2:]
    assert status == "2"
    assert float(megabytes) < MEGABYTES
    assert "Traceback" not in ended.stderr


@pytest.mark.parametrize(
    ("head", "said"),
    [
        (
            one_topic("nav_msgs/msg/Odometry", b"std_msgs/Header header\n\0\xff =====\nfloat64[9999999999] x"),
            "holds no episode",
        ),
        (one_topic("a/msg/A", "a/A a"), "nothing says where the robot was (types: a/msg/A)"),
        (
            one_topic("foxglove.Pose", "", "protobuf", "protobuf"),
            "its messages are encoded as protobuf; allowed: cdr (ROS 2) and ros1",
        ),
        (one_topic("", ""), "nothing says where the robot was"),
    ],
)
def test_definitions_that_are_damaged_are_one_line(
    tmp_path: Path, head: bytes, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.mcap").write_bytes(head + message(10**9, bytes(80)) * 3 + record(mcap.DATA_END, bytes(4)))
    assert main(["ros", "import", str(tmp_path / "a.mcap"), f"--out={tmp_path / 'out'}", "robot=turtlebot3"]) == 2
    assert said in capsys.readouterr().err.splitlines()[-1]


@pytest.mark.parametrize("content", [b"no zstd", zstd.compress(np.random.default_rng(0).bytes(90_000))[:50_000]])
def test_compressed_file_that_is_damaged_is_one_line(
    tmp_path: Path, content: bytes, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.mcap.zstd").write_bytes(content)
    assert main(["ros", "import", str(tmp_path / "a.mcap.zstd"), f"--out={tmp_path / 'out'}"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "cannot be unpacked" in line


def test_messages_out_of_order_are_held_up_to_a_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told = write_recording(tmp_path / "a.mcap", sorted(drive_messages(), key=lambda each: each.topic))
    monkeypatch.setattr(stream, "LARGEST_OVERLAP", 20_000)
    with open_bags([told]) as (bag,):
        stamps = [recorded for _, recorded, _ in bag.messages(())]
    assert "are not in the order of time" in bag.cut
    assert stamps == sorted(stamps)


def test_old_name_of_transforms_is_known() -> None:
    assert stream.ros2_type_name("tf/tfMessage") == "tf2_msgs/msg/TFMessage"
    assert get_codec(1).has_type(stream.ros2_type_name("tf/tfMessage"))


@pytest.mark.skipif(not STRANGERS.is_dir(), reason="needs the shared recordings")
@pytest.mark.parametrize(
    "name", ["base.mcap", "by_topic.mcap", "goal_odom.mcap", "old_tf.bag", "ros1.mcap", "file_zstd", "message_zstd"]
)
def test_drive_is_the_same_however_it_is_told(tmp_path: Path, name: str) -> None:
    (found,) = import_recording(STRANGERS / name, tmp_path / "out")
    assert_baseline(found)


@pytest.mark.skipif(not STRANGERS.is_dir(), reason="needs the shared recordings")
@pytest.mark.parametrize("name", ["sim_drift.mcap", "skew_-5.mcap"])
def test_drive_by_another_clock_takes_as_long(tmp_path: Path, name: str) -> None:
    (found,) = import_recording(STRANGERS / name, tmp_path / "out")
    np.testing.assert_allclose(found["pose"][0, :2], [1.01, 2.03], atol=0.01)
    assert found["stamp"][-1] == pytest.approx(9.5)
    assert path_length(found) == pytest.approx(4.75, abs=0.01)


@pytest.mark.skipif(not STRANGERS.is_dir(), reason="needs the shared recordings")
def test_people_and_goals_of_strangers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (found,) = import_recording(STRANGERS / "people_odom.mcap", tmp_path / "people")
    assert found["clearance_people"].min() == pytest.approx(0.59, abs=0.01)
    print_notice.cache_clear()
    import_recording(STRANGERS / "goal_nan.mcap", tmp_path / "goal")
    assert "a goal that is no number; left out" in capsys.readouterr().err
