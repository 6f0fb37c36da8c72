"""Robots, what they see, and a policy that no one has trained."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from arena_cadrl.perception import Perception, StateSettings
from arena_cadrl.policy import action_ends
from arena_core import Robot
from arena_core.parameters import read_settings
from arena_core.testing import component
from arena_policies.actions import ActionRange
from arena_policies.card import PolicyCard, content_sha256, write_card


@cache
def body(name: str) -> Robot:
    """Return an installed robot."""
    made: Robot = component("robot", name)
    return made


@cache
def composed(name: str) -> dict:
    """Return what `arena train planner=sarl` composes for a robot."""
    from arena_gym.building import compose_environment

    return compose_environment(["recipe=sarl", f"robot={name}"], primary="train")


@cache
def state_settings(name: str, planner: str = "sarl") -> StateSettings:
    """Return what a robot's policy is shown and chooses from."""
    own = {key: composed(name)["trainer"][key] for key in ("looking", "choosing", "safety", "worth")}
    return read_settings({"name": planner, **own}, StateSettings, "trainer")


@pytest.fixture(scope="session")
def robot() -> Callable[[str], Robot]:
    """Give a function that returns an installed robot by name."""
    return body


@pytest.fixture(scope="session")
def eyes() -> Callable[..., Perception]:
    """Give a function that returns the eyes of a robot by name, and the margin to people."""

    @cache
    def _eyes(name: str, margin: float = 0.0) -> Perception:
        range_ = read_settings(composed(name)["action"], ActionRange, "action")
        return Perception(body(name), range_, state_settings(name), margin)

    return _eyes


@pytest.fixture(scope="session")
def written(tmp_path_factory, eyes) -> Callable[..., Path]:
    """Give a function that writes a policy with its card: planner's and robot's name.

    No one has trained it, and all states are worth the same to it: the step ahead decides, not chance.
    """
    import torch

    from arena_cadrl.training.networks import make_network
    from arena_cadrl.training.settings import ValueSettings
    from arena_gym.training.export import network_to_onnx

    @cache
    def _content(planner: str, size: int) -> bytes:
        torch.manual_seed(0)
        kinds = {
            "sarl": ValueSettings("attention", (8, 8), (8,), (8,), (8,), ""),
            "cadrl": ValueSettings("pairs", (8,), (), (), (), ""),
        }
        network = make_network(kinds[planner])
        torch.nn.init.zeros_((network.head if planner == "sarl" else network.value)[-1].weight)
        return network_to_onnx(network, size, "state", "value")

    @cache
    def _written(planner: str = "sarl", name: str = "jackal") -> Path:
        config, settings = composed(name), state_settings(name, planner)
        content = _content(planner, eyes(name).size)
        path, range_ = (
            tmp_path_factory.mktemp("policy") / "policy.onnx",
            read_settings(config["action"], ActionRange, "action"),
        )
        path.write_bytes(content)
        made = body(name)
        own = made.name, made.kinematics, made.control_period
        told = json.loads(json.dumps(asdict(settings)))
        layout, ends = eyes(name).layout(), action_ends(made, range_)
        write_card(
            path.with_suffix(".json"),
            PolicyCard(planner, *own, told, layout, ends, config["action"], content_sha256(content)),
        )
        return path

    return _written


@pytest.fixture
def random() -> np.random.Generator:
    """Give a generator of random numbers."""
    return np.random.default_rng(0)
