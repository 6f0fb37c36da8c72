"""Good files of each kind that the suite reads: what the fuzz suite begins with and spoils."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from PIL import Image

from arena_core import OccupancyGrid, Pose


@cache
def cells() -> np.ndarray:
    """Return a room of 40 by 40 cells with a wall around it."""
    data = np.zeros((40, 40), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    return data


def room() -> OccupancyGrid:
    """Return that room, 4 m by 4 m."""
    return OccupancyGrid(cells(), 0.1, Pose(0.0, 0.0))


def picture(kind: str, mode: str) -> bytes:
    """Return an image of the room."""
    grey = np.where(cells() > 0, 0, 254).astype(np.uint8)
    image, content = Image.fromarray(grey), io.BytesIO()
    image.convert(mode).save(content, kind)
    return content.getvalue()


MAP = (
    b"image: site.pgm\nresolution: 0.1\norigin: [0.0, 0.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: "
    b"0.196\nmode: trinary\n"
)
LINES = b"type: line_segments\ndata: walls.dat\nscale: 1.0\norigin: [0.0, 0.0, 0.0]\n"
WALLS = b"0 0 3 0\n3 0 3 3\n3 3 0.5 2.5\n"
FLATLAND_WORLD = (
    b"properties:\n  velocity_iterations: 10\nlayers:\n- name: static\n  map: map.yaml\n  color: [0, 1, 0, "
    b"1]\nmodels: []\n"
)
MODEL = b"""bodies:
- name: shelf
  pose: [0.0, 0.0, 0.1]
  footprints:
  - {type: circle, radius: 0.2, center: [0.1, 0.0], layers: [all], collision: true}
  - {type: polygon, points: [[0.0, 0.0], [0.3, 0.0], [0.3, 0.3]], sensor: false}
"""
CURRICULUM = b"""levels:
  0: {difficulty: null, obstacles: 0, pedestrians: 0, pedestrian_speed: 0.3, speed_share: 0.5}
  1: {difficulty: 0.2, obstacles: 2, pedestrians: 3, pedestrian_speed: 0.3, speed_share: 1.0, min_distance: 2.0,
    max_distance: 5.0}
"""
PERSON = {
    "position": [2, 1],
    "waypoints": [[3, 1], [2, 3]],
    "desired_speed": 0.5,
    "radius": 0.3,
    "behaviour": {"type": "adult", "wait_time": 2},
}
OBSTACLES = [{"center": [1.0, 3.0], "radius": 0.2}, {"vertices": [[3, 3], [3.2, 3], [3.2, 3.2]]}]
THINGS = {"obstacles": OBSTACLES, "furniture": [{"kind": "chair", "pose": [2.5, 1.0, 0.3]}]}
PROBLEM = {
    "name": "a",
    "repeats": 2,
    "start": [1, 1, 0],
    "goal": [3, 3],
    "pedestrians": [PERSON],
    **THINGS,
    "time_limit": 60,
}
OURS = {
    "format": "arena-scenario",
    "version": 2,
    "title": "t",
    "map": "map.yaml",
    "scenarios": [PROBLEM, {**PROBLEM, "name": "b"}],
}
AGENT = {
    "name": "p",
    "id": 1,
    "pos": [2, 1],
    "type": "adult",
    "number_of_peds": 2,
    "vmax": 0.5,
    "waypoints": [[3, 1], [2, 3]],
    "waypoint_mode": 1,
}
TOOLS = {
    "pedsim_agents": [AGENT],
    "static_obstacles": [{"name": "s", "pos": [1, 3], "yaml_path": "shelf.model.yaml"}],
    "interactive_obstacles": [],
    "robot_position": [1, 1],
    "robot_goal": [3, 3],
    "resets": 3,
    "map_path": "maps/site/map.yaml",
}
ROSNAV = {
    "map": "site",
    "resets": 2,
    "robots": [{"start": [1, 1, 0], "goal": [3, 3, 0]}],
    "obstacles": {"dynamic": [AGENT], "static": [{"model": "shelf", "pos": [1, 3]}], "interactive": []},
}
SCENE = {
    "scene_name": "s",
    "repeats": 2,
    "robot": {"start_pos": [1, 1, 0], "goal_pos": [3, 3, 0]},
    "dynamic_obstacles": {
        "d": {
            "obstacle_radius": 0.3,
            "linear_velocity": 0.3,
            "start_pos": [2, 1, 0],
            "waypoints": [[1, 1, 0]],
            "is_waypoint_relative": True,
            "mode": "yoyo",
            "triggers": ["w"],
        }
    },
    "static_obstacles": {
        "o": {"shape": "circle", "x": 1, "y": 3, "radius": 0.2},
        "p": {"shape": "polygon", "vertices": [[3, 3], [3.2, 3], [3, 3.2]]},
    },
    "watchers": {"w": {"pos": [2, 2], "range": 1.0}},
}
PACK = {
    "format": "arena-pack",
    "id": "mine",
    "version": "1",
    "title": "t",
    "licence": "MIT",
    "files": {"map.yaml": "0" * 64},
}
SOURCE = b"""anim(new common::PoseAnimation("m", 2.00, true));
key = anim->CreateKeyFrame(0.00);
key->Translation(ignition::math::Vector3d(1.00, 2.00, 0));
key = anim->CreateKeyFrame(2.00);
key->Translation(ignition::math::Vector3d(3.00, 2.00, 0));
"""
DYNABARN = b"""<sdf version="1.6"><world name="d"><include><uri>model://sun</uri></include>
<model name="wall"><static>1</static><pose>0 0 0 0 0 0</pose><link name="l"><collision name="c"><geometry>
<box><size>0.5 20 1</size></box></geometry>
</collision></link></model>
<model name="m"><pose>1 2 0 0 0 0</pose><link name="l"><collision name="c"><geometry>
<cylinder><radius>0.3</radius><length>1</length></cylinder></geometry>
</collision></link><plugin name="m" filename="m.so"/></model></world></sdf>"""
MJCF = b"""<mujoco model="m"><compiler angle="radian"/><worldbody><body name="map" pos="0 0 0" euler="0 0 0.1">
<geom name="floor" type="plane" size="3 3 0.1" pos="3 3 0"/><geom name="b" type="box" size="0.3 0.3 0.5" pos="1 1 0.5"/>
<body name="c" pos="2 2 0" quat="1 0 0 0"><geom type="cylinder" size="0.3 0.5"/></body></body></worldbody></mujoco>"""
TRACKS = {
    "frames.txt": b"# unit: m, framerate: 10\n0 1 0.0 0.0\n1 1 0.1 0.0\n2 1 0.2 0.0\n0 2 "
    b"3.0 1.0\n1 2 2.9 1.0\n2 2 2.8 1.0\n",
    "obsmat.txt": b"# framerate: 15\n# unit: m\n0 1 0.0 0 0.0 0.5 0 0.0\n6 1 0.2 0 0.0 0.5 0 0.0\n"
    b"12 1 0.4 0 0.0 0.5 0 0.0\n18 1 0.6 0 0.0 0.5 0 0.0\n",
    "juelich.txt": b"# framerate: 16 fps\n# x/y/z in cm\n1 0 10.0 20.0 170\n1 1 15.0 20.0 170\n1 2 20.0 20.0 170\n"
    b"2 0 10.0 90.0 170\n2 1 12.0 90.0 170\n",
}


def dumped(tree: Any) -> Callable[[], bytes]:
    """Return what writes a tree as JSON."""
    return lambda: json.dumps(tree).encode()


def npy(array: np.ndarray) -> Callable[[], bytes]:
    """Return what writes an array."""

    def write() -> bytes:
        content = io.BytesIO()
        np.save(content, array)
        return content.getvalue()

    return write


def rollouts() -> bytes:
    """Return roll-outs of two robots."""
    content = io.BytesIO()
    np.savez(
        content,
        scans=np.zeros((3, 2, 4), np.float16),
        states=np.zeros((3, 2, 5), np.float16),
        begins=np.zeros((3, 2), bool),
    )
    return content.getvalue()


def gazebo() -> bytes:
    """Return the room as a Gazebo world."""
    from arena_worlds.formats.sdf_writer import sdf_text
    from arena_worlds.formats.solids import solids_of

    return sdf_text(solids_of(room()).raised(1.0), "room").encode()


def const(content: bytes) -> Callable[[], bytes]:
    """Return what gives a content."""
    return lambda: content
