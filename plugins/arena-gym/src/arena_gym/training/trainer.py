"""One training: rollouts and updates, levels, evaluations, checkpoints, the exported policy."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback

from arena_core import Staging, write_text_whole
from arena_gym.training.evaluation import Score, evaluate
from arena_gym.training.learning import limit_spread, load_checkpoint, make_learner, save_checkpoint
from arena_gym.training.report import TrainingReport
from arena_gym.training.settings import TrainingSettings
from arena_gym.training.worlds_in_step import WorldsInStep
from arena_gym.vector_environment import NavigationVectorEnv

CHECKPOINT, CURVE = "checkpoint.pt", "curve.json"
LATE = 300  # episodes whose success the bar shows


class Trainer(BaseCallback):
    """Watches a learner: moves it between levels, evaluates it, keeps it, and says when it is good enough."""

    def __init__(
        self,
        learner: PPO,
        settings: TrainingSettings,
        staging: Staging | None,
        worlds: NavigationVectorEnv,
        evaluation: NavigationVectorEnv,
        folder: Path,
        report: TrainingReport,
    ) -> None:
        super().__init__()
        self._learner = learner
        self._settings, self._staging = settings, staging
        self._worlds, self._evaluation = worlds, evaluation
        self._folder, self._report = folder, report
        self._late: deque[bool] = deque(maxlen=LATE)
        self._block: list[bool] = []
        self.stage = staging.start if staging else 0
        self.curve: list[dict[str, float]] = []
        self._next_evaluation = settings.evaluation.every
        self._good_enough = False

    def resume(self, progress: Mapping[str, Any]) -> None:
        """Go on where a checkpoint left."""
        self.stage, self.curve = int(progress["stage"]), list(progress["curve"])
        self._next_evaluation = int(progress["next_evaluation"])

    def _on_training_start(self) -> None:
        self._enter(self.stage)

    def _on_rollout_start(self) -> None:
        initial, final = self._settings.network.log_std_init, self._settings.network.log_std_final
        if final is not None:
            limit_spread(self._learner, initial + min(self.num_timesteps / self._settings.total_steps, 1.0) * (final - initial))

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if "episode" in info:
                self._ended(bool(info["is_success"]))
        return not self._good_enough

    def _ended(self, success: bool) -> None:
        self._late.append(success)
        self._block.append(success)
        if self._staging is not None and len(self._block) >= self._staging.block:
            following = self._staging.next(self.stage, self._block)
            self._block = []
            if following != self.stage:
                self._enter(following)

    def _enter(self, stage: int) -> None:
        self.stage = stage
        if self._staging is not None:
            self._worlds.set_stage(stage)

    def _on_rollout_end(self) -> None:
        self._report.note(self.num_timesteps, self._late_success(), self.stage)
        self.logger.record("train/success", self._late_success())
        self.logger.record("train/level", self.stage)
        if self.num_timesteps >= self._next_evaluation:
            self._next_evaluation = self.num_timesteps + self._settings.evaluation.every
            self._evaluate()

    def _late_success(self) -> float:
        return sum(self._late) / len(self._late) if self._late else 0.0

    def _evaluate(self) -> None:
        score = self.score()
        self.curve.append({"steps": self.num_timesteps, "level": self.stage, "training": self._late_success(), **score.as_row()})
        self.logger.record("evaluation/success", score.success)
        print(
            f"{self.num_timesteps:>9} steps, level {self.stage}, success {self._late_success():.2f}; evaluation: "
            f"success {score.success:.3f}, collision {score.collision:.3f}, time out {score.time_out:.3f} of {score.episodes}",
            flush=True,
        )
        target = self._settings.evaluation.target
        on_top = self._staging is None or self.stage == self._staging.levels - 1
        self._good_enough = target is not None and on_top and score.success >= target
        self.keep()

    def score(self) -> Score:
        """Evaluate the policy as it is, without exploration, on the last level."""
        learner, chosen = self._learner, self._settings.evaluation
        return evaluate(self._evaluation, lambda seen: learner.predict(seen, deterministic=True)[0], chosen.episodes, chosen.seed)

    def keep(self) -> None:
        """Write checkpoint and curve."""
        progress = {"steps": self.num_timesteps, "stage": self.stage, "curve": self.curve, "next_evaluation": self._next_evaluation}
        save_checkpoint(self._folder / CHECKPOINT, self._learner, progress)
        write_text_whole(self._folder / CURVE, json.dumps(self.curve, indent=1) + "\n")


def train(
    settings: TrainingSettings, env: NavigationVectorEnv, evaluation: NavigationVectorEnv, staging: Staging | None, folder: Path
) -> tuple[PPO, list[dict[str, float]], Score]:
    """Train until the steps are spent or the target is reached; return the learner, the curve of its evaluations and the last score.

    ``folder`` keeps checkpoint, curve and logs; where there is a checkpoint, its training goes on. Raises ConfigurationError for one
    of another training.
    """
    worlds = WorldsInStep(env, settings.seed)
    learner = make_learner(worlds, env.batch.parts.encoder.layout(), settings, folder / "tensorboard")
    with TrainingReport(settings.total_steps) as report:
        trainer = Trainer(learner, settings, staging, env, evaluation, folder, report)
        if (folder / CHECKPOINT).exists():
            progress = load_checkpoint(folder / CHECKPOINT, learner)
            trainer.resume(progress)
            learner.num_timesteps = int(progress["steps"])
            worlds.resume(learner.num_timesteps)
        left = settings.total_steps - learner.num_timesteps
        if left > 0:
            learner.learn(left, trainer, tb_log_name="ppo", reset_num_timesteps=False)
            trainer.keep()
        return learner, trainer.curve, trainer.score()
