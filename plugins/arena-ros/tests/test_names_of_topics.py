"""What topics mean in recordings that spell their names otherwise: in a namespace, without a
slash, of several robots.
"""

from __future__ import annotations

import sqlite3
from dataclasses import replace
from pathlib import Path

import pytest

from arena_core.cli.main import main
from arena_ros.bags.stream import Channel
from arena_ros.bags.topic_roles import assign_roles, common_namespace
from arena_ros.testing.synthetic_recording import (
    RecordedMessage,
    assert_baseline,
    drive_messages,
    goal_message,
    import_recording,
    in_order,
    write_recording,
)

TYPES = {
    "odom": "nav_msgs/msg/Odometry",
    "scan": "sensor_msgs/msg/LaserScan",
    "cmd_vel": "geometry_msgs/msg/Twist",
    "goal_pose": "geometry_msgs/msg/PoseStamped",
    "tf": "tf2_msgs/msg/TFMessage",
    "map": "nav_msgs/msg/OccupancyGrid",
}


def channels(*topics: str) -> dict[Channel, int]:
    return {Channel(topic, TYPES[topic.rpartition("/")[2]], 2): 10 for topic in topics}


def given(*topics: str) -> dict[str, str]:
    return {role: channel.topic for role, channel in assign_roles(channels(*topics), {}).by_role.items()}


def renamed(told: list[RecordedMessage], space: str, but: tuple[str, ...] = ()) -> list[RecordedMessage]:
    return [one if one.topic in but else replace(one, topic=f"{space}{one.topic}") for one in told]


@pytest.mark.parametrize("but", [(), ("/tf", "/tf_static")], ids=["all", "all but transforms"])
def test_robot_in_a_namespace_has_its_goal(tmp_path: Path, but: tuple[str, ...]) -> None:
    bag = write_recording(tmp_path / "a.db3", in_order(renamed([*drive_messages(), *goal_message()], "/robot1", but)))
    (record,) = import_recording(bag, tmp_path / "out")
    assert_baseline(record)


def test_messages_of_another_type_on_a_topic_are_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bag = write_recording(tmp_path / "a.db3", in_order([*drive_messages(), *goal_message()]))
    with sqlite3.connect(bag) as database:
        names = [row[1] for row in database.execute("PRAGMA table_info(topics)")]
        row = dict(zip(names, database.execute("SELECT * FROM topics WHERE name = '/odom'").fetchone(), strict=True))
        own, row["id"], row["type"] = row["id"], 99, "tf2_msgs/msg/TFMessage"
        database.execute(f"INSERT INTO topics VALUES ({','.join('?' * len(row))})", tuple(row.values()))
        first = "SELECT id FROM messages WHERE topic_id = ? LIMIT 1"
        database.execute(f"UPDATE messages SET topic_id = 99 WHERE id IN ({first})", (own,))
    (record,) = import_recording(bag, tmp_path / "out")
    assert_baseline(record)
    assert "/odom: is a tf2_msgs/msg/TFMessage too; those messages are left out" in capsys.readouterr().err


def test_names_without_a_slash_are_known() -> None:
    assert given("odom", "goal_pose", "tf") == {"odometry": "odom", "goal": "goal_pose", "tf": "tf"}


def test_common_transforms_and_map_belong_to_the_robot_in_a_namespace() -> None:
    found = given("/a/b/odom", "/a/b/goal_pose", "/tf", "/map")
    assert found == {"odometry": "/a/b/odom", "goal": "/a/b/goal_pose", "tf": "/tf", "map": "/map"}


def test_goal_of_one_of_several_robots_is_not_guessed() -> None:
    assert "goal" not in given("/a/odom", "/a/goal_pose", "/b/odom", "/b/goal_pose")
    assert "goal" not in given("/odom", "/b/odom", "/b/goal_pose")
    assert given("/odom", "/goal_pose", "/b/odom", "/b/goal_pose")["goal"] == "/goal_pose"


def test_topic_of_a_driver_is_no_namespace() -> None:
    assert common_namespace(channels("/odom", "/scan", "/cmd_vel")) == ""
    assert (
        common_namespace(
            [Channel("/jackal_velocity_controller/odom", TYPES["odom"], 1), Channel("/front/scan", TYPES["scan"], 1)]
        )
        == ""
    )
    assert (
        common_namespace(
            [
                Channel("/x/jackal_velocity_controller/odom", TYPES["odom"], 1),
                Channel("/x/front/scan", TYPES["scan"], 1),
            ]
        )
        == "/x"
    )


def test_a_bag_that_ends_in_its_first_chunk_is_refused_with_the_reason(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from arena_ros.testing.recordings import write_laboratory

    bag = write_laboratory(tmp_path / "a.bag", 1.0)
    bag.write_bytes(bag.read_bytes()[:8000])
    assert main(["ros", "import", str(bag), f"--out={tmp_path / 'out'}"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "nothing says where the robot was (types: none; " in line
    assert "a.bag: it ends within a record)" in line
