"""A world model and a controller with weights at random: what has to fit, and what has to be refused, does
not ask how good they are.
"""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from arena_core import testing
from arena_policies.actions import ActionRange, ActionScale
from arena_policies.card import PolicyCard, content_sha256, part_path, write_card

SCAN = {
    "name": "rosnav_sectors",
    "sectors": 30,
    "overlap": 4,
    "lookback": [],
    "range_max": 8.0,
    "decay": 1.0,
    "distance_unit": 2.0,
}
RANGE = {"vx_min": 0.0, "vx_max": None, "vy_max": None, "wz_max": None, "steering_max": None}


def linear_model(inputs, outputs, only=slice(None)):
    """Return an ONNX model of one layer with fixed weights, which reads ``only`` some columns."""
    from onnx import TensorProto, helper, numpy_helper

    weights = np.zeros((inputs, outputs), np.float32)
    weights[only] = np.random.default_rng(0).normal(0.0, 0.1, weights[only].shape)
    graph = helper.make_graph(
        [helper.make_node("MatMul", ["observation", "weights"], ["action"])],
        "linear",
        [helper.make_tensor_value_info("observation", TensorProto.FLOAT, ["worlds", inputs])],
        [helper.make_tensor_value_info("action", TensorProto.FLOAT, ["worlds", outputs])],
        [numpy_helper.from_array(weights, "weights")],
    )
    return helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9).SerializeToString()


@cache
def random_networks(beams, motion):
    """Return vision and memory with weights at random, as files hold them: traced once, which takes a second each."""
    import torch

    from arena_gym.training.export import network_to_onnx
    from arena_gym.training.settings import Convolution
    from arena_navrep.training.memory import Memory
    from arena_navrep.training.vision import Vision

    torch.manual_seed(0)
    vision = network_to_onnx(Vision(beams, 6, [Convolution(4, 5, 2)], 0.1, 0.0), beams, "scan", "code")
    return vision, network_to_onnx(Memory(6, motion, 8, 3), 6 + motion + 8, "recalled", "remembered")


def scaled(content, by):
    """Return a network with other weights: each so many times as large."""
    from onnx import TensorProto, load_from_string, numpy_helper

    model = load_from_string(content)
    for tensor in model.graph.initializer:
        if tensor.data_type == TensorProto.FLOAT:
            tensor.CopyFrom(numpy_helper.from_array(numpy_helper.to_array(tensor) * np.float32(by), tensor.name))
    return model.SerializeToString()


def write_world_model(folder, robot, scale=1.0):
    """Write vision and memory with weights at random, so many times as large."""
    from arena_core.hosting import load_registry
    from arena_navrep.world_model import PartCard, write_part

    layout = load_registry().build("observation_encoder", SCAN, robot=robot).layout()
    motion = 6 if robot.holonomic else 4
    vision, memory = (scaled(part, scale) for part in random_networks(layout[0].size, motion))
    own = robot.name, SCAN, layout
    write_part(
        folder / "vision.onnx",
        vision,
        PartCard("vision", *own, layout[0].size, 6, 6, 0, content_sha256(vision), content_sha256(vision)),
    )
    write_part(
        folder / "memory.onnx",
        memory,
        PartCard("memory", *own, 14 + motion, 14, 6, 8, content_sha256(vision), content_sha256(memory)),
    )


def write_policy(folder, robot, world_model, memory=True):
    """Write a controller at random with its card and its world model beside it."""
    encoder = testing.component("observation_encoder", "navrep", encoder_words(world_model, memory), robot=robot)
    scale = ActionScale.of(robot, ActionRange(**RANGE))
    content = linear_model(sum(field.size for field in encoder.layout()), len(scale.names))
    path = folder / "policy.onnx"
    path.write_bytes(content)
    for name in encoder.parts():
        for suffix in (".onnx", ".json"):
            part_path(path, name).with_suffix(suffix).write_bytes((world_model / name).with_suffix(suffix).read_bytes())
    card = PolicyCard(
        "navrep" if memory else "navrep_v_only",
        robot.name,
        robot.kinematics,
        robot.control_period,
        {"name": "navrep", "vision": None, "memory": None},
        encoder.layout(),
        {n: (low, high) for n, low, high in zip(scale.names, scale.low.tolist(), scale.high.tolist(), strict=True)},
        RANGE,
        content_sha256(content),
        parts={name: content_sha256((world_model / f"{name}.onnx").read_bytes()) for name in encoder.parts()},
    )
    write_card(path.with_suffix(".json"), card)
    return path


def encoder_words(world_model, memory=True):
    """Return the overrides that choose a world model."""
    chosen = str(world_model / "memory.onnx") if memory else "null"
    return [f"observation_encoder.vision={world_model / 'vision.onnx'}", f"observation_encoder.memory={chosen}"]


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    """Return world models and controllers for a Jackal, of two kinds and two seeds."""
    pytest.importorskip("torch", reason="networks are made with the extra arena-navrep[train]")
    top, robot = tmp_path_factory.mktemp("navrep"), testing.component("robot", "jackal")
    folders = {name: top / name for name in ("world", "other_world", "policy", "v_only")}
    for folder in folders.values():
        folder.mkdir()
    write_world_model(folders["world"], robot)
    write_world_model(folders["other_world"], robot, scale=1.1)
    policy = write_policy(folders["policy"], robot, folders["world"])
    v_only = write_policy(folders["v_only"], robot, folders["world"], memory=False)
    return SimpleNamespace(
        robot=robot,
        linear_model=linear_model,
        sha256=content_sha256,
        write_world_model=write_world_model,
        words=encoder_words,
        world=folders["world"],
        other_world=folders["other_world"],
        policy=policy,
        v_only=v_only,
    )
