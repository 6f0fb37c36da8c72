"""One training: rollouts and updates, levels, validations, checkpoints."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import Logger

from arena_core import ArenaError, Reward
from arena_core.commands import interrupts
from arena_core.files import write_text_whole
from arena_core.hosting import RunFolderError
from arena_gym.training.checkpoint import Weights, all_finite, load_checkpoint, save_checkpoint, weights_of
from arena_gym.training.evaluation import evaluate_policy
from arena_gym.training.export import Actor
from arena_gym.training.ground_truth import GroundTruth
from arena_gym.training.imitation import IMITATED_FILE, ImitationWorlds, imitate_expert
from arena_gym.training.initial_weights import freeze_policy, load_weights
from arena_gym.training.learner import Learner
from arena_gym.training.learning import limit_spread, make_learner, scale_exploration, spread_in_si
from arena_gym.training.levels import Levels
from arena_gym.training.plan import final_steps
from arena_gym.training.report import RecentEpisodes, TrainingReport
from arena_gym.training.sb3_vec_env import Sb3VecEnv
from arena_gym.training.selection import Choice, is_better, latest_choice
from arena_gym.training.settings import TrainingSettings
from arena_gym.vector_environment import NavigationVectorEnv

CHECKPOINT, CURVE = "checkpoint.pt", "curve.json"
NO_NUMBER = (
    "the loss is no number (a smaller training.optimization.learning_rate or max_gradient may help, with out=DIR)"
)


class TrainingStopped(ArenaError):
    """A training could not go on (disk full, weights that are no numbers); its last checkpoint is kept."""


@dataclass(frozen=True, slots=True, eq=False)
class TrainingResult:
    """What a training made: a learner with its last weights after ``steps``, its curve, and the
    weights that were chosen.
    """

    learner: Learner
    steps: int
    curve: list[dict[str, float]]
    choice: Choice
    best: Weights


@dataclass(frozen=True, slots=True, eq=False)
class TrainingCourse:
    """Where a policy trains: worlds on their levels, others to validate it in, and a classroom to imitate an expert
    first; from some share of the steps on it is judged by the reward ``later``, if any. ``write_best`` writes the
    policy as it is, with what its card is to tell, when it is the best so far.
    """

    worlds: Sb3VecEnv
    validation: NavigationVectorEnv
    levels: Levels
    later: Reward | None = None
    classroom: ImitationWorlds | None = None
    write_best: Callable[[Mapping[str, Any]], None] | None = None


class TrainingCallback(BaseCallback):
    """Watches a learner: moves its worlds between levels, validates it, keeps it, and says when it is good enough.

    All that matters happens between an update and the next rollout, where a checkpoint holds the whole state.
    """

    def __init__(
        self,
        learner: Learner,
        settings: TrainingSettings,
        course: TrainingCourse,
        folder: Path,
        report: TrainingReport,
    ) -> None:
        super().__init__()
        self._learner, self._settings, self._levels = learner, settings, course.levels
        self._worlds, self._validation, self._later = course.worlds, course.validation, course.later
        self._write_best, self._folder, self._report = course.write_best, folder, report
        self._late = RecentEpisodes()
        self._next_validation = settings.validation.every
        self._kept_at = time.monotonic()
        self.curve: list[dict[str, float]] = []
        self.choice: Choice | None = None
        self.best: Weights | None = None
        self.kept = 0
        self.good_enough = False

    def resume(self, progress: Mapping[str, Any], best: Weights | None) -> None:
        """Go on where a checkpoint left."""
        self._levels.restore(progress["levels"])
        self._late.restore(progress["late"])
        self._next_validation = int(progress["next_validation"])
        self.curve, self.best = list(progress["curve"]), best
        self.choice = None if progress["choice"] is None else Choice.of(progress["choice"])
        self.good_enough = bool(progress["good_enough"])
        self.kept = self._learner.num_timesteps

    def resume_checkpoint(self) -> None:
        """Take the state of the folder's checkpoint, if there is one; its running episodes only where training goes
        on.
        """
        file = self._folder / CHECKPOINT
        if not file.exists():
            return
        progress, best = load_checkpoint(file, self._learner)
        self.resume(progress, best)
        if self._learner.num_timesteps < self._settings.total_steps and not self.good_enough:
            self._report.start_side_task("episodes that ran are driven again", 1)
            if progress.get("real_guidance", False):
                self._worlds.env.batch.lead_by_real_parts()
            load_checkpoint(file, self._learner, self._worlds)
            self._report.update_side_task(1)

    def _on_rollout_start(self) -> None:
        self._report.end_rollout(self._learner.num_timesteps)
        self._after_update()
        self._give_real_guidance()
        self._report.begin_rollout()
        if self._settings.exploration_time is not None and self._learner.num_timesteps == 0:
            scale_exploration(self._learner, self._learner.observations)
        if self._settings.begins_able:
            freeze_policy(self._learner, held=self._learner.num_timesteps < self._settings.start.value_steps)
        if (
            self._later is not None
            and self._learner.num_timesteps >= self._settings.later.share * self._settings.total_steps
        ):
            self._worlds.env.batch.reward = self._later
        initial, final = self._settings.network.log_std_init, self._settings.network.log_std_final
        if final is not None:
            limit_spread(
                self._learner,
                initial + min(self._learner.num_timesteps / self._settings.total_steps, 1.0) * (final - initial),
            )

    def _give_real_guidance(self) -> None:
        """Let all episodes begin again with the real parts of guides where a model has stood for them long enough."""
        batch = self._worlds.env.batch
        model = batch.parts.guidance_model if batch.led_by_model else None
        if model is not None and self._learner.num_timesteps >= (1.0 - model.real_share) * self._settings.total_steps:
            observations = self._worlds.lead_by_real_parts()
            self._learner.restore_observations(observations, np.ones(len(observations), bool))

    def _on_step(self) -> bool:
        interrupts.check()
        for info in self.locals["infos"]:
            if "episode" in info:
                success = bool(info["is_success"])
                self._late.add(int(info["episode"]["c"]), success=success)
                self._levels.record_episode(info["stage"], batch=self._worlds.env.batch, success=success)
        self._report.note(self._learner.num_timesteps, self._late, self._level_text())
        return not self.good_enough

    def _on_rollout_end(self) -> None:
        self.logger.record("train/success", self._late.success)
        self.logger.record("train/collisions", self._late.collisions)
        self.logger.record("train/level", self._levels.mean)
        for level, share in enumerate(self._levels.level_shares()):
            self.logger.record(f"levels/{level}", share)

    def _after_update(self) -> None:
        """Check the weights, validate them and write a checkpoint where it is time to; tell the worlds their levels."""
        self._check_weights()
        self._levels.apply(self._worlds.env.batch)
        steps = self._learner.num_timesteps
        due = steps >= self._next_validation
        if time.monotonic() - self._kept_at >= self._settings.checkpoint and steps > self.kept:
            self.save_progress()  # ahead of a validation, too, which takes its time
        if due:
            self.validate()

    def validate(self) -> None:
        """Validate the weights as they are, take them where they are best, and keep all."""
        chosen, steps = self._settings.validation, self._learner.num_timesteps
        self._next_validation = steps + chosen.every
        heard = self._report.start_evaluation(f"validation after {steps} steps, episodes", chosen.episodes)
        begun, act = time.monotonic(), Actor(self._learner.policy).act
        score = evaluate_policy(self._validation, act, chosen.episodes, chosen.seed, heard)
        self._report.end_validation(time.monotonic() - begun)
        training = {"training": self._late.success, "training_collisions": self._late.collisions}
        self.curve.append({"steps": steps, "level": self._levels.mean, **training, **score.as_row()})
        found = latest_choice(self.curve, chosen)
        if is_better(found, self.choice):
            self.choice, self.best = found, weights_of(self._learner)
        self.good_enough = chosen.target is not None and self._levels.may_end and score.success >= chosen.target
        self._learner.logger.record("validation/success", score.success)
        self._learner.logger.record("validation/collision", score.collision)
        self._learner.logger.record("validation/mean", found.success)
        print(
            f"{steps:>9} steps{self._level_text()}, success {self._late.success:.2f}, "
            f"collisions {self._late.collisions:.2f}; validation: "
            f"success {score.success:.3f}, collision {score.collision:.3f}, "
            f"time out {score.time_out:.3f} of {score.episodes}, "
            f"mean of {found.validations} {found.success:.3f}{', the best' if self.choice is found else ''}",
            flush=True,
        )
        self.save_progress()
        if self._write_best is not None and self.choice is found:
            self._write_best({"steps": steps, "curve": self.curve, "choice": found.as_row()})

    def finish(self) -> None:
        """Validate the last weights, unless that was done."""
        if not self.good_enough and (not self.curve or self.curve[-1]["steps"] < self._learner.num_timesteps):
            self._check_weights()
            self._report.end_rollout(self._learner.num_timesteps)
            self.validate()

    def save_progress(self) -> None:
        """Write checkpoint and curve."""
        progress = {
            "levels": self._levels.state(),
            "late": self._late.state(),
            "curve": self.curve,
            "next_validation": self._next_validation,
            "choice": self.choice.as_row() if self.choice else None,
            "good_enough": self.good_enough,
            "real_guidance": not self._worlds.env.batch.led_by_model,
        }
        save_checkpoint(self._folder / CHECKPOINT, self._learner, self._worlds, progress, self.best)
        write_text_whole(self._folder / CURVE, json.dumps(self.curve, indent=1) + "\n")
        self._kept_at, self.kept = time.monotonic(), self._learner.num_timesteps

    def _check_weights(self) -> None:
        if not all_finite(self._learner):
            raise TrainingStopped(self._stop_message(NO_NUMBER))

    def _level_text(self) -> str:
        return f", level {self._levels.mean:.3g}" if self._levels.state() else ""

    def _stop_message(self, what: str) -> str:
        if self.kept:
            there = f"{self._folder / CHECKPOINT} holds the training up to {self.kept} steps"
        elif (self._folder / IMITATED_FILE).exists():
            there = f"{self._folder / IMITATED_FILE} holds what the lessons taught that are over"
        else:
            there = "there is no checkpoint as yet"
        return f"after {self._learner.num_timesteps} steps {what}; {there}"

    @contextmanager
    def stopping_in_one_line(self) -> Iterator[None]:
        """Turn what ends a training into one line that says what is kept."""
        try:
            yield
        except RunFolderError as error:
            raise TrainingStopped(self._stop_message(f"it {error}")) from error
        except OSError as error:  # of what writes the logs
            raise TrainingStopped(
                self._stop_message(f"it cannot write to {self._folder}: {error.strerror or error}")
            ) from error
        except ValueError as error:  # of what draws actions, where a weight is no number
            if all_finite(self._learner):
                raise
            raise TrainingStopped(self._stop_message(NO_NUMBER)) from error


def prepare_learner(settings: TrainingSettings, env: NavigationVectorEnv, folder: Path) -> tuple[Learner, Sb3VecEnv]:
    """Return a learner as it begins, with the worlds that it drives in; ``folder`` will have its logs.

    Raises InputFileError or ConfigurationError for weights that it cannot begin with.
    """
    worlds = Sb3VecEnv(env, settings.seed, GroundTruth(settings.truth) if settings.critic == "truth" else None)
    parts = env.batch.parts
    learner = make_learner(worlds, parts.encoder.layout(), settings, folder / "tensorboard")
    if settings.network.log_std_unit == "si":
        spread_in_si(learner, parts.scale)
    if settings.start.policy is not None:
        load_weights(learner, settings.start.policy, parts.encoder.layout())
    return learner, worlds


def train_policy(
    settings: TrainingSettings,
    learner: Learner,
    course: TrainingCourse,
    folder: Path,
    report: TrainingReport | None = None,
) -> TrainingResult:
    """Train until the steps are spent or the target is reached.

    Where there is a classroom, the policy imitates its teacher at first. ``folder`` keeps checkpoint, curve and
    logs; where there is a checkpoint, its training goes on as if it had never stopped. Raises ConfigurationError for
    one of another training, TrainingStopped where it cannot go on.
    """
    report = report or TrainingReport(settings.total_steps)  # which shows nothing, as no one has started it
    trainer = TrainingCallback(learner, settings, course, folder, report)
    worlds, levels, classroom = course.worlds, course.levels, course.classroom
    with trainer.stopping_in_one_line():
        if classroom is not None:
            levels.apply(worlds.env.batch)
            imitate_expert(learner, classroom, settings.teacher, settings.seed, folder, report)
        trainer.resume_checkpoint()
        levels.apply(worlds.env.batch)
        total = final_steps(settings, learner.num_timesteps)
        report.begin(learner.num_timesteps, total, settings.validation.every)
        left = settings.total_steps - learner.num_timesteps
        learner.last_step = total
        if left > 0 and not trainer.good_enough:
            learner.learn(left, trainer, tb_log_name="ppo", reset_num_timesteps=False)
        else:
            learner.set_logger(Logger(None, []))  # which `learn` would have made
            if not trainer.curve:
                worlds.reset()  # to the episodes that a checkpoint goes on with
        trainer.finish()
    assert trainer.choice is not None
    assert trainer.best is not None
    return TrainingResult(learner, int(trainer.curve[-1]["steps"]), trainer.curve, trainer.choice, trainer.best)
