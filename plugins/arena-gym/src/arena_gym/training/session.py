"""A whole training: environments, learner, policy and card."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError, ObservationEncoder, local_path, read_settings, write_bytes_whole
from arena_gym.building import Parts, build_parts
from arena_gym.training.evaluation import Score, unseen_worlds
from arena_gym.training.export import to_onnx
from arena_gym.training.folder import open_folder
from arena_gym.training.settings import TrainingSettings
from arena_gym.training.trainer import train
from arena_gym.vector_environment import NavigationVectorEnv
from arena_policies.actions import ActionRange, ActionScale
from arena_policies.card import PolicyCard, part_path, sha256, write_card
from arena_policies.network import network_content

PACKAGES = ("arena-core", "arena-gym", "arena-policies", "arena-sim2d", "arena-pedsim", "torch", "stable-baselines3", "onnx")


def run_training(config: Mapping[str, Any], folder: Path, resume: bool) -> int:
    """Train by a composed configuration; write ``policy.onnx`` and ``policy.json`` to ``folder``, which may hold its beginning."""
    settings = training_settings(config)
    parts, chosen = build_parts(config), settings.evaluation
    if parts.switch is not None and settings.network.log_std_final is not None:
        raise ConfigurationError(
            f"training.network.log_std_final is {settings.network.log_std_final:g}; allowed: null for a switch, which has no spread"
        )
    evaluation = unseen_worlds(config, chosen.episodes, chosen.seed, "training.evaluation.seed")
    open_folder(folder, config, resume)  # once all is built: a request that is refused leaves nothing behind
    env = NavigationVectorEnv(settings.optimization.environments, parts=parts)
    learner, curve, score = train(settings, env, evaluation, parts.pool.staging, folder)
    content = to_onnx(learner)
    write_bytes_whole(folder / "policy.onnx", content)
    networks = _write_parts(folder / "policy.onnx", parts.encoder)
    card = _card(config, parts, content, learner.num_timesteps, curve, score)
    write_card(folder / "policy.json", replace(card, parts=networks))
    print(f"policy: {folder / 'policy.onnx'}")
    return 0


def training_settings(config: Mapping[str, Any]) -> TrainingSettings:
    """Return the settings of a composed configuration; raise ConfigurationError."""
    shared = {key: config[key] for key in ("planner", "seed", "total_steps", "device")}
    return read_settings({**shared, **config["training"]}, TrainingSettings, "training")


def _write_parts(policy: Path, encoder: ObservationEncoder) -> dict[str, str]:
    """Copy the networks that the encoder runs to the policy's side, with their cards; return their hashes."""
    hashes = {}
    for name, address in encoder.parts().items():
        source, target = local_path(address), part_path(policy, name)
        content = network_content(source)
        write_bytes_whole(target, content)
        write_bytes_whole(target.with_suffix(".json"), source.with_suffix(".json").read_bytes())
        hashes[name] = sha256(content)
    return hashes


def _card(config: Mapping[str, Any], parts: Parts, content: bytes, steps: int, curve: list[dict[str, float]], score: Score) -> PolicyCard:
    switch = parts.switch
    action_range = dict.fromkeys(config["action"]) if switch else config["action"]  # members have their own, up to the robot's limits
    scale = ActionScale.of(parts.robot, read_settings(action_range, ActionRange, "action"))
    ends = zip(scale.names, scale.low.tolist(), scale.high.tolist(), strict=True)
    return PolicyCard(
        planner=config["planner"],
        robot=parts.robot.name,
        kinematics=parts.robot.kinematics,
        control_period=parts.robot.control_period,
        encoder={**config["observation_encoder"], **dict.fromkeys(parts.encoder.parts())},
        layout=parts.encoder.layout(),
        action={name: (low, high) for name, low, high in ends},
        action_range=action_range,
        sha256=sha256(content),
        training={
            "seed": config["seed"],
            "steps": steps,
            "curve": curve,
            "score": {**score.as_row(), "seed": config["training"]["evaluation"]["seed"]},
            "config": dict(config),
            "versions": {name: version(name) for name in PACKAGES},
        },
        members=switch.members if switch else {},
        every=switch.every if switch else 1,
    )
