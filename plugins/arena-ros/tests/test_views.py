"""Configurations of RViz and Foxglove show what recordings have: each topic with the display of its type."""

import json
import re
from importlib.resources import files

import pytest
import yaml

from arena_core import ConfigurationError
from arena_ros.bags.exporting import GOAL, LATCHED
from arena_ros.commands import RosCommand

TABLE = {
    "/map": "Map",
    "/scan": "LaserScan",
    "/people_markers": "MarkerArray",
    "/plan": "Path",
    "/waypoint": "Pose",
    "/goal_pose": "Pose",
    "/move_base_simple/goal": "Pose",
    "/ground_truth": "Odometry",
    "/amcl_pose": "PoseWithCovariance",
}


def shown(name):
    """Return the display of each topic of a configuration of RViz."""
    content = yaml.safe_load((files("arena_ros") / "views" / name).read_text())
    found = {}
    for display in content["Visualization Manager"]["Displays"]:
        topic = display.get("Topic", display.get("Marker Topic"))
        if topic is not None:
            found[topic["Value"] if isinstance(topic, dict) else topic] = display
    return content, found


@pytest.mark.parametrize(("ros", "name"), [(1, "arena.rviz"), (2, "arena_ros2.rviz")])
def test_rviz_shows_each_topic_by_the_display_of_its_type(ros, name):
    content, displays = shown(name)
    assert {topic: display["Class"].rpartition("/")[2] for topic, display in displays.items()} == {
        topic: kind for topic, kind in TABLE.items() if topic not in set(GOAL.values()) - {GOAL[ros]}
    }
    assert content["Visualization Manager"]["Global Options"]["Fixed Frame"] == "map"


def test_what_is_sent_once_is_asked_for_as_latched():
    _, displays = shown("arena_ros2.rviz")
    latched = {t for t, d in displays.items() if d["Topic"]["Durability Policy"] == "Transient Local"}
    assert latched == LATCHED & set(displays)


def test_foxglove_shows_topics_that_recordings_have():
    layout = json.loads((files("arena_ros") / "views" / "foxglove.json").read_text())
    scene = layout["configById"]["3D!arena"]
    assert set(scene["topics"]) == set(TABLE) - {GOAL[1]}
    panels = set(re.findall(r'"(?:first|second)": "([^"]+)"', json.dumps(layout["layout"])))
    assert panels == set(layout["configById"])


def test_views_are_written_once(tmp_path, capsys):
    assert RosCommand().run(["views", f"out={tmp_path / 'views'}"]) == 0
    names = sorted(path.name for path in (tmp_path / "views").iterdir())
    assert names == ["arena.rviz", "arena_ros2.rviz", "foxglove.json"]
    with pytest.raises(ConfigurationError, match=r"arena\.rviz is there already"):
        RosCommand().run(["views", f"out={tmp_path / 'views'}"])
