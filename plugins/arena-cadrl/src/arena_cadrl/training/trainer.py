"""``arena train planner=cadrl`` and ``planner=sarl``: rounds of driving and learning, evaluations,
checkpoints, policy and card.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import torch

from arena_cadrl.parameters import ActionSettings, PerceptionSettings, RewardSettings, Safety
from arena_cadrl.perception import Perception, StateSettings
from arena_cadrl.policy import action_ends
from arena_cadrl.training.learner import Learner, State
from arena_cadrl.training.rollouts import Explorer, chosen_commands, collect_rollout, state_values
from arena_cadrl.training.settings import Learning, ValueSettings
from arena_cadrl.training.worlds import VectorWorlds
from arena_core import random_generator
from arena_core.files import write_bytes_whole, write_text_whole
from arena_core.hosting import Registry, Trainer, compose, load_registry, to_plain
from arena_core.parameters import NonNegativeInt, PositiveInt, read_settings
from arena_gym.batch import NavigationBatch
from arena_gym.building import Parts, build_parts
from arena_gym.seeds import training_seed
from arena_gym.training.evaluation import Score, unseen_worlds
from arena_gym.training.export import network_to_onnx
from arena_gym.training.folder import open_folder
from arena_gym.training.learning import choose_device
from arena_policies.actions import ActionRange
from arena_policies.card import PolicyCard, content_sha256, write_card

CHECKPOINT, CURVE = "checkpoint.pt", "curve.json"
PACKAGES = (
    "arena-core",
    "arena-cadrl",
    "arena-gym",
    "arena-orca",
    "arena-policies",
    "arena-sim2d",
    "arena-crowds",
    "torch",
    "onnx",
)
EPISODES_APART = 2**20  # between the episode seeds of a training's parts


@dataclass(frozen=True, slots=True)
class Evaluation:
    """When and on how many problems the policy is tried: every ``every`` steps, with
    ``episodes`` of the worlds of ``seed``.
    """

    every: PositiveInt
    episodes: PositiveInt
    seed: NonNegativeInt


@dataclass(frozen=True, slots=True)
class Request:
    """What is asked of a training on the command line."""

    planner: str
    seed: NonNegativeInt
    total_steps: PositiveInt
    device: str


class ValueTrainer(Trainer):
    """Learns values of states: first of those that a teacher gets to, then of those that the best actions lead to.

    ``teacher`` is a planner by name, tuned for the robot as in a benchmark.
    """

    def __init__(
        self,
        network: ValueSettings,
        learning: Learning,
        looking: PerceptionSettings,
        choosing: ActionSettings,
        safety: Safety,
        worth: RewardSettings,
        evaluation: Evaluation,
        threads: PositiveInt,
        teacher: str,
        local_map: dict[str, Any],
        tracker: dict[str, Any],
    ) -> None:
        self._network, self._learning, self._evaluation = network, learning, evaluation
        self._looking, self._choosing, self._safety, self._worth = looking, choosing, safety, worth
        self._threads, self._teacher = threads, teacher
        self._nodes = {"local_map": local_map, "tracker": tracker}

    def train(self, config: Mapping[str, Any], folder: Path, *, resume: bool) -> None:
        """Train by a composed configuration; write ``policy.onnx`` and ``policy.json`` to
        ``folder``, which may hold its beginning.
        """
        torch.set_num_threads(self._threads)
        asked = read_settings({key: config[key] for key in ("planner", "seed", "total_steps", "device")}, Request, "")
        registry, device = load_registry(), choose_device(asked.device)
        parts, chosen = build_parts(config), self._evaluation
        teacher = to_plain(compose([f"planner={self._teacher}", f"robot={parts.robot.name}"]))["planner"]
        unseen = unseen_worlds(config, chosen.episodes, chosen.seed, "trainer.evaluation.seed").batch
        settings = StateSettings(config["planner"], self._looking, self._choosing, self._safety, self._worth)
        # contacts are learned from
        eyes = Perception(parts.robot, read_settings(config["action"], ActionRange, "action"), settings, 0.0)
        batch = NavigationBatch(parts, self._learning.environments)
        worlds, unseen_ones = (self._worlds(each, eyes, teacher, registry) for each in (batch, unseen))
        open_folder(folder, config, resume=resume)  # once all is built: a request that is refused leaves nothing behind
        learner = Learner(self._network, self._learning, config["seed"], device)
        session = Session(self, config, learner, worlds, unseen_ones, folder)
        session.run()
        self._export_policy(config, parts, eyes, settings, session, folder)

    @property
    def learning(self) -> Learning:
        """Return how values are learned."""
        return self._learning

    @property
    def evaluation(self) -> Evaluation:
        """Return when and on what the policy is tried."""
        return self._evaluation

    @property
    def discount(self) -> float:
        """Return what a second's delay leaves of a value."""
        return self._worth.discount

    def _worlds(
        self, batch: NavigationBatch, eyes: Perception, teacher: Mapping[str, Any], registry: Registry
    ) -> VectorWorlds:
        return VectorWorlds(
            batch, eyes, lambda: registry.build("planner", teacher, robot=batch.parts.robot), self._nodes, registry
        )

    def _export_policy(
        self,
        config: Mapping[str, Any],
        parts: Parts,
        eyes: Perception,
        settings: StateSettings,
        session: Session,
        folder: Path,
    ) -> None:
        learner = session.learner
        learner.average.load_state_dict(session.best)
        content = network_to_onnx(learner.average, eyes.size, "state", "value")
        range_ = read_settings(config["action"], ActionRange, "action")
        training = {
            "seed": config["seed"],
            "steps": session.steps,
            "differs": self._network.differs,
            "curve": session.curve,
            "chosen": session.chosen,
            "score": {**session.score, "seed": self._evaluation.seed},
            "config": dict(config),
            "versions": {name: version(name) for name in PACKAGES},
        }
        robot = parts.robot
        card = PolicyCard(
            planner=config["planner"],
            robot=robot.name,
            kinematics=robot.kinematics,
            control_period=robot.control_period,
            encoder=json.loads(json.dumps(asdict(settings))),
            layout=eyes.layout(),
            action=action_ends(robot, range_),
            action_range=config["action"],
            sha256=content_sha256(content),
            training=training,
        )
        write_bytes_whole(folder / "policy.onnx", content)
        write_card(folder / "policy.json", card)
        print(f"policy: {folder / 'policy.onnx'}")


class Session:
    """One training: what has been done, the best weights so far, and the curve of evaluations."""

    def __init__(
        self,
        trainer: ValueTrainer,
        config: Mapping[str, Any],
        learner: Learner,
        worlds: VectorWorlds,
        unseen: VectorWorlds,
        folder: Path,
    ) -> None:
        self.learner = learner
        self._trainer, self._config = trainer, config
        self._worlds, self._unseen, self._folder = worlds, unseen, folder
        self.steps, self._rounds, self._next_evaluation = 0, 0, trainer.evaluation.every
        self.curve: list[dict[str, float]] = []
        self.best: State = {}
        self.chosen: dict[str, float] = {}
        self.score: dict[str, float] = {}
        if (folder / CHECKPOINT).exists():
            self._resume_progress()

    def run(self) -> None:
        """Train until the steps are spent."""
        total, learning = self._config["total_steps"], self._trainer.learning
        seed = self._config["seed"]
        first = seed * 64 * EPISODES_APART + self.steps
        random = random_generator(training_seed(seed), f"exploration/{self.steps}", "exploration")
        explorer = Explorer(learning.environments, learning.held, random)
        if self.steps < total:
            self._worlds.begin([first + k * EPISODES_APART for k in range(learning.environments)])
        while self.steps < total:
            self._train_round(explorer, self.steps / total)
            if self.steps >= self._next_evaluation or self.steps >= total:
                self._next_evaluation = self.steps + self._trainer.evaluation.every
                self._evaluate_policy()
            self._save_progress()

    def _train_round(self, explorer: Explorer, done: float) -> None:
        learning, period = self._trainer.learning, self._worlds.batch.parts.robot.control_period
        teaching = done < learning.imitation
        share = learning.exploration + (learning.final_exploration - learning.exploration) * done
        discount = self._trainer.discount ** (period * learning.every)
        lesson = collect_rollout(self._worlds, self.learner.run, explorer, learning, discount, share, teaching=teaching)
        self._rounds += 1
        loss = self.learner.learn(lesson, self._rounds, 1.0 - done)
        self.steps += learning.decisions * learning.every * learning.environments
        print(
            f"{self.steps:>9} steps, {'teacher' if teaching else 'network'} drives: {lesson.arrived} arrived, "
            f"{lesson.collided} collided, "
            f"{lesson.timed_out} timed out; mean worth {lesson.worth.mean():.3f}, loss {loss:.4f}",
            flush=True,
        )

    def _evaluate_policy(self) -> None:
        """Try the averaged weights in worlds of no training; keep them where they and those
        before them are the best on average.
        """
        score = evaluate_weights(self._unseen, self.learner, self._trainer.evaluation)
        before = self.curve[-1]["success"] if self.curve else 0.0
        self.curve.append({"steps": self.steps, **score.as_row(), "average": 0.5 * (before + score.success)})
        if not self.chosen or self.curve[-1]["average"] >= self.chosen["average"]:
            self.chosen, self.score = self.curve[-1], score.as_row()
            self.best = {name: value.clone() for name, value in self.learner.average.state_dict().items()}
        print(
            f"{self.steps:>9} steps; evaluation: success {score.success:.3f}, collision {score.collision:.3f}, "
            f"time out {score.time_out:.3f} of {score.episodes}",
            flush=True,
        )

    def _save_progress(self) -> None:
        progress = {
            "steps": self.steps,
            "rounds": self._rounds,
            "next_evaluation": self._next_evaluation,
            "curve": self.curve,
            "chosen": self.chosen,
            "score": self.score,
        }
        self.learner.save(self._folder / CHECKPOINT, progress, self.best)
        write_text_whole(self._folder / CURVE, json.dumps(self.curve, indent=1) + "\n")

    def _resume_progress(self) -> None:
        """Go on where a checkpoint left: with its weights, in episodes that it did not meet."""
        progress, self.best = self.learner.load(self._folder / CHECKPOINT)
        self.steps, self._rounds = int(progress["steps"]), int(progress["rounds"])
        self._next_evaluation = int(progress["next_evaluation"])
        self.curve, self.chosen, self.score = list(progress["curve"]), dict(progress["chosen"]), dict(progress["score"])


def evaluate_weights(worlds: VectorWorlds, learner: Learner, settings: Evaluation) -> Score:
    """Return how well the averaged weights drive, without chance, in the first episodes of each world."""
    count = worlds.batch.worlds
    quota = np.full(count, settings.episodes // count)
    quota[: settings.episodes % count] += 1
    ended: list[list[str]] = [[] for _ in range(count)]
    worlds.begin([settings.seed + k for k in range(count)])
    nothing = np.full(count, -1)
    while any(len(world) < wanted for world, wanted in zip(ended, quota.tolist(), strict=True)):
        seen = worlds.observe(teaching=False)
        step = worlds.drive(chosen_commands(seen, state_values(learner.run_averaged, seen)[:, 1:], nothing))
        for slot in np.flatnonzero(step.terminated | step.truncated).tolist():
            if len(ended[slot]) < quota[slot]:
                outcome = "collision" if step.collided[slot] else "goal_reached" if step.arrived[slot] else "time_out"
                ended[slot].append(outcome)
    flat = [outcome for world in ended for outcome in world]
    return Score(len(flat), *(flat.count(outcome) / len(flat) for outcome in ("goal_reached", "collision", "time_out")))
