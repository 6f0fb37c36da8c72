"""A whole training: environments, learner, policy and card."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError, ObservationEncoder
from arena_core.commands import announce_compiling, interrupts
from arena_core.files import local_path, read_json, write_bytes_whole, write_text_whole
from arena_core.hosting import digest_code, load_registry
from arena_core.parameters import read_settings
from arena_core.statistics import wilson
from arena_gym.building import Parts, build_parts
from arena_gym.straight_way import Decisions, StraightWay, straight_way
from arena_gym.training.checkpoint import digest_of, steps_of
from arena_gym.training.evaluation import check_distinct_seeds, evaluate_policy, unseen_worlds
from arena_gym.training.export import Actor, PolicyExport, round_weights
from arena_gym.training.folder import open_folder
from arena_gym.training.imitation import ImitationWorlds
from arena_gym.training.interruption import is_tested, save_on_interrupt
from arena_gym.training.levels import make_levels
from arena_gym.training.plan import describe_plan
from arena_gym.training.report import TrainingReport
from arena_gym.training.selection import rule_text
from arena_gym.training.settings import TrainingSettings
from arena_gym.training.tracking import check_wandb, shown_to_wandb
from arena_gym.training.trainer import CHECKPOINT, TrainingCourse, TrainingResult, prepare_learner, train_policy
from arena_gym.vector_environment import NavigationVectorEnv
from arena_policies.actions import ActionRange, ActionScale
from arena_policies.card import PolicyCard, content_sha256, part_path, read_card, write_card
from arena_policies.learning_facts import learned_by
from arena_policies.network import network_content

PACKAGES = (
    "arena-core",
    "arena-gym",
    "arena-policies",
    "arena-sim2d",
    "arena-crowds",
    "torch",
    "stable-baselines3",
    "onnx",
)
TESTED = "test.json"
# sections and keys beside `training` that a training reads
SHARED = ("planner", "seed", "total_steps", "device", "teacher", "later", "horizon", "exploration_time", "allow_unpaid")
NO_PART = ("metrics", "executor", "command", "listing")  # kinds that have no part in a training


def run_training(
    config: Mapping[str, Any], folder: Path, robot: str | None = None, *, resume: bool, force: bool = False
) -> int:
    """Train by a composed configuration; write the best weights to ``folder``, which may hold its beginning, the last
    to ``last`` in it.

    ``robot`` is the name of its file, by which a teacher is tuned, and which the card names; its own where it is None.
    Ctrl-C comes between two steps: within a compiled kernel it would turn into another error.
    """
    with interrupts.heard(), interrupts.held():
        return _run_training(config, folder, robot, resume=resume, force=force)


def _run_training(config: Mapping[str, Any], folder: Path, robot: str | None, *, resume: bool, force: bool) -> int:
    print(f"{config['planner']} for {robot or config['robot']['name']}, to {folder}: building its worlds", flush=True)
    settings = training_settings(config)
    check_distinct_seeds(config)
    check_wandb(config["wandb"])
    registry = load_registry()
    parts, chosen = build_parts(config, registry), settings.validation
    interrupts.check()
    announce_compiling()
    if parts.switch is not None:
        _check_switch(settings)
    elif settings.total_steps:
        _check_reward(parts, settings)
    levels = make_levels(settings.levels, parts.pool.staging, settings.mixture)
    validation = unseen_worlds(config, chosen.episodes, chosen.seed, "training.validation.seed")
    for pool in (parts.pool, validation.batch.parts.pool):
        # worlds in which none can be drawn are told of now
        (pool.at_stage(pool.staging.start) if pool.staging else pool).check()
    interrupts.check()
    env = NavigationVectorEnv(settings.optimization.environments, parts=parts)
    changed = settings.later.reward
    later = None if changed is None else registry.build("reward", {**config["reward"], **changed}, robot=parts.robot)
    teacher = settings.teacher.planner
    classroom = None if teacher is None else ImitationWorlds(env.batch, teacher, robot or parts.robot.name, registry)
    learner, worlds = prepare_learner(settings, env, folder)
    besides = ("gym",) if classroom is None else ("gym", classroom.plugin)
    code = digest_code(config, registry, apart=NO_PART, besides=besides)
    compared = config if classroom is None else {**config, "teacher": {**config["teacher"], "nodes": classroom.nodes}}
    # once all is built: a request that is refused leaves nothing behind
    before = open_folder(folder, compared, code, resume=resume, force=force)
    told: dict[str, Any] = {"code": code.digest, **({"code_before": before} if before else {})}
    if classroom is not None:
        told["teacher"] = {"code": code.parts, **classroom.node}
        for note in classroom.untuned:
            print(f"note: {note}", flush=True)
    if (folder / CHECKPOINT).exists():
        classroom = None  # it has taught
    for line in describe_plan(settings, steps_of(folder / CHECKPOINT), taught=classroom is None):
        print(line, flush=True)
    export = PolicyExport(learner, sum(field.size for field in parts.encoder.layout()))
    writer = PolicyWriter(config, parts, robot or parts.robot.name, export)
    told = {**_training_info(config), **told}

    def write(found: Mapping[str, Any]) -> None:
        writer.write(folder / "policy.onnx", {**told, **found})

    def write_best(found: Mapping[str, Any]) -> None:
        if not is_tested(folder / "policy.onnx"):
            writer.write(folder / "policy.onnx", {**told, **found, "weights": "best", "score": None})

    interrupts.check()
    with (
        shown_to_wandb(config["wandb"], folder, config),
        TrainingReport(settings.total_steps) as report,
        save_on_interrupt(learner, folder, write),
    ):
        course = TrainingCourse(worlds, validation, levels, later, classroom, write_best)
        trained = train_policy(settings, learner, course, folder, report)
        line = _export_policies(writer, trained, told, folder, report)
    print(line)
    print(f"policy: {folder / 'policy.onnx'}")
    return 0


def describe_reward(config: Mapping[str, Any]) -> tuple[StraightWay, TrainingSettings]:
    """Return what a composed configuration's rewards pay, and its settings; raise ConfigurationError where it cannot
    be built.
    """
    settings = training_settings(config)
    return _straight_way(build_parts(config), settings), settings


def _straight_way(parts: Parts, settings: TrainingSettings) -> StraightWay:
    chosen = parts.settings
    decisions = Decisions(settings.discount(parts.decision_period), chosen.every, chosen.standing_to_end)
    return straight_way(parts.reward, parts.robot, decisions)


def _check_reward(parts: Parts, settings: TrainingSettings) -> None:
    """Say what the rewards pay; raise ConfigurationError where they pay nobody, unless the recipe allows it."""
    way = _straight_way(parts, settings)
    if not settings.allow_unpaid:
        way.check()
    print(f"reward: {way.describe()}", flush=True)


def _check_switch(settings: TrainingSettings) -> None:
    """Refuse what says how actions spread: those of a switch are none that could."""
    network = settings.network
    if settings.exploration_time is not None:
        raise ConfigurationError(
            f"exploration_time is {settings.exploration_time:g}; allowed: null for a switch, which has no spread"
        )
    if network.log_std_final is not None:
        raise ConfigurationError(
            f"training.network.log_std_final is {network.log_std_final:g}; allowed: null for a switch, "
            "which has no spread"
        )
    if network.log_std_unit == "si":
        raise ConfigurationError(
            "training.network.log_std_unit is si; allowed: range for a switch, whose actions have no unit"
        )


def _training_info(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a card tells of a training, whatever came of it."""
    told: dict[str, Any] = {
        "seed": config["seed"],
        "config": dict(config),
        "versions": {name: version(name) for name in PACKAGES},
    }
    if (begun := training_settings(config).start.policy) is not None:
        path = local_path(begun)
        told["start"] = content_sha256(network_content(path))
        told["start_learned_by"] = learned_by(read_card(path.with_suffix(".json")).training)
    return told


@dataclass(frozen=True, slots=True, eq=False)
class PolicyWriter:
    """Writes policies of one training for a robot, with their cards."""

    config: Mapping[str, Any]
    parts: Parts
    robot: str
    export: PolicyExport

    def write(self, path: Path, told: dict[str, Any]) -> None:
        """Write the weights that the learner has now, the networks that its encoder runs, and a card that tells."""
        content = self.export.content()
        write_bytes_whole(path, content)
        card = make_card(self.config, self.parts, self.robot, content, told)
        write_card(path.with_suffix(".json"), replace(card, parts=_write_parts(path, self.parts.encoder)))


def _export_policies(
    writer: PolicyWriter, trained: TrainingResult, by: Mapping[str, Any], folder: Path, report: TrainingReport
) -> str:
    """Write the last weights, then those that were chosen, with what a test says of them; return that.

    ``by`` tells of the configuration, the code, and a teacher.
    """
    config, told = writer.config, {**by, "steps": trained.steps, "curve": trained.curve}
    writer.write(folder / "last" / "policy.onnx", {**told, "weights": "last", "score": None})
    trained.learner.policy.load_state_dict(trained.best)
    round_weights(Actor(trained.learner.policy))
    score = (
        _test_score(config, trained, by["code"], folder / TESTED, report)
        if training_settings(config).test.episodes
        else None
    )
    choice = {**trained.choice.as_row(), "rule": rule_text(training_settings(config).validation)}
    path = folder / "policy.onnx"
    writer.write(path, {**told, "weights": "best", "choice": choice, "score": score})
    weights = f"weights after {trained.choice.steps} of {trained.steps} steps"
    if score is None:
        return f"test: none; {weights}"
    low, high = score["interval"]
    return (
        f"test: success {score['success']:.3f} ({low:.3f} .. {high:.3f}), collision {score['collision']:.3f}, time out "
        f"{score['time_out']:.3f} of {score['episodes']}; {weights}"
    )


def _test_score(
    config: Mapping[str, Any], trained: TrainingResult, code: str, file: Path, report: TrainingReport
) -> dict[str, Any]:
    """Return the score of the chosen weights in the test, from ``file`` where this ``code`` tested them before."""
    chosen = training_settings(config).test
    of = {"weights": digest_of(trained.best), "seed": chosen.seed, "wanted": chosen.episodes, "code": code}
    if file.exists():
        before = read_json(file, "what `arena train` wrote after a test")
        if isinstance(before, dict) and before.get("of") == of:
            return dict(before["score"])
    print(f"test: {chosen.episodes} episodes ...", flush=True)
    worlds = unseen_worlds(config, chosen.episodes, chosen.seed, "training.test.seed")
    heard = report.start_evaluation("test, episodes", chosen.episodes)
    found = evaluate_policy(worlds, Actor(trained.learner.policy).act, chosen.episodes, chosen.seed, heard)
    score = {
        **found.as_row(),
        "interval": list(wilson(found.success, found.episodes)),
        "method": "Wilson, 95 %",
        "seed": chosen.seed,
    }
    write_text_whole(file, json.dumps({"of": of, "score": score}, indent=1) + "\n")
    return score


def training_settings(config: Mapping[str, Any]) -> TrainingSettings:
    """Return the settings of a composed configuration; raise ConfigurationError."""
    shared = {key: config[key] for key in SHARED}
    return read_settings({**shared, **config["training"]}, TrainingSettings, "training")


def _write_parts(policy: Path, encoder: ObservationEncoder) -> dict[str, str]:
    """Copy the networks that the encoder runs to the policy's side, with their cards; return their hashes."""
    hashes = {}
    for name, address in encoder.parts().items():
        source, target = local_path(address), part_path(policy, name)
        content = network_content(source)
        write_bytes_whole(target, content)
        write_bytes_whole(target.with_suffix(".json"), source.with_suffix(".json").read_bytes())
        hashes[name] = content_sha256(content)
    return hashes


def make_card(
    config: Mapping[str, Any], parts: Parts, robot: str, content: bytes, told: Mapping[str, Any]
) -> PolicyCard:
    """Return the card of a policy for ``robot`` that was trained by a configuration; ``told`` is its training."""
    switch = parts.switch
    # members have their own, up to the robot's limits
    action_range = dict.fromkeys(config["action"]) if switch else config["action"]
    scale = ActionScale.of(parts.robot, read_settings(action_range, ActionRange, "action"))
    ends = zip(scale.names, scale.low.tolist(), scale.high.tolist(), strict=True)
    return PolicyCard(
        planner=config["planner"],
        robot=robot,
        kinematics=parts.robot.kinematics,
        control_period=parts.robot.control_period,
        encoder={**config["observation_encoder"], **dict.fromkeys(parts.encoder.parts())},
        layout=parts.encoder.layout(),
        action={name: (low, high) for name, low, high in ends},
        action_range=action_range,
        sha256=content_sha256(content),
        training=told,
        members=switch.members if switch else {},
        every=switch.every if switch else parts.settings.every,
    )
