"""Configurations of RViz and Foxglove show what recordings have: each topic with the display of its type."""

import json
import re
from importlib.resources import files
from xml.etree import ElementTree

import pytest
import yaml

from arena_core import ConfigurationError
from arena_ros.bags.exporting import GOAL, LATCHED
from arena_ros.commands import RosCommand
from arena_ros.live.controller import KEYS, PLUGINS

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


def test_launch_file_starts_a_controller_that_takes_its_words():
    root = ElementTree.fromstring((files("arena_ros") / "views" / "nav2_arena.launch.xml").read_text())
    arguments = {each.get("name") for each in root.iter("arg")}
    texts = [value for node in root.iter() for value in node.attrib.values()]
    assert {name for text in texts for name in re.findall(r"\$\(var (\w+)\)", text)} == arguments
    command = root.find("executable").get("cmd")
    assert command.startswith("arena ros controller ")
    assert set(re.findall(r"(\w+)=", command)) <= {"planner", "robot", *KEYS}
    assert any(text.endswith("nav2_arena_tree.xml") for text in texts)


def test_tree_of_nav2_follows_the_path_that_it_plans():
    tree = ElementTree.fromstring((files("arena_ros") / "views" / "nav2_arena_tree.xml").read_text())
    assert tree.find(".//ComputePathToPose").get("path") == tree.find(".//FollowPath").get("path")
    assert tree.get("main_tree_to_execute") == tree.find("BehaviorTree").get("ID")
    assert tree.find(".//FollowPath").get("controller_id") in PLUGINS["controllers"].split(",")


def test_views_are_written_once(tmp_path, capsys):
    assert RosCommand().run(["views", f"out={tmp_path / 'views'}"]) == 0
    names = sorted(path.name for path in (tmp_path / "views").iterdir())
    assert names == [
        "arena.rviz",
        "arena_ros2.rviz",
        "foxglove.json",
        "nav2_arena.launch.xml",
        "nav2_arena_tree.xml",
    ]
    with pytest.raises(ConfigurationError, match=r"arena\.rviz is there already"):
        RosCommand().run(["views", f"out={tmp_path / 'views'}"])
