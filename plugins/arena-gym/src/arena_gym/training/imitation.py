"""A planner that teaches: a policy begins by imitating it, before it learns from rewards.

Dataset aggregation (S. Ross, G. Gordon, D. Bagnell, A reduction of imitation learning and structured prediction to
no-regret online learning, AISTATS 2011): the policy drives more and more of the worlds itself, and the teacher says
what it would have done there.
"""

from __future__ import annotations

import io
import shutil
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3 import PPO

from arena_core import ConfigurationError, random_generator
from arena_core.commands import interrupts
from arena_core.files import write_bytes_whole
from arena_core.hosting import Registry, compose, to_plain
from arena_core.records import missing_tunings
from arena_gym.batch import NavigationBatch
from arena_gym.driver import Driver
from arena_gym.privileged import allowed_privileged
from arena_gym.reports import episode_outcome
from arena_gym.seeds import training_seed
from arena_gym.training.checkpoint import all_finite, checkpoint_errors
from arena_gym.training.export import Actor
from arena_gym.training.report import TrainingReport
from arena_gym.training.sb3_vec_env import SEEDS_APART
from arena_gym.training.settings import ExpertSettings
from arena_gym.training.time_left import ImitationPace
from arena_policies.members import Members

IMITATED_FILE, ROLLOUTS_FOLDER = "taught.pt", "lessons"
_FIRST_SEED = SEEDS_APART // 2  # of the worlds of lessons, which no rollout has; they come again after so many
Rows = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class ExpertRollout:
    """What was seen in a round, (M, D), and the actions of the teacher there, (M, A)
    in [-1, 1]; how its episodes ended.
    """

    seen: Rows
    shown: Rows
    ends: Counter[str]


class ImitatingNetwork(Protocol):
    """A network that can imitate."""

    def parameters(self) -> Iterator[torch.nn.Parameter]:
        """Return its weights."""
        ...

    def action_means(self, observation: torch.Tensor) -> torch.Tensor:
        """Return the actions (N, A) for observations (N, D), before they are cut to their ranges."""
        ...


class ImitationWorlds:
    """Worlds in step with a teacher beside each robot, with the tuning for ``robot``, by the name of its file, if there
    is one.

    It decides as often as the policy does. ``nodes`` are its configuration and that of what it sees by, ``node`` is its
    own, ``plugin`` the entry point that it comes from; ``missing_tunings`` says which of its tunings the robot has not.
    """

    def __init__(self, batch: NavigationBatch, teacher: str, robot: str, registry: Registry) -> None:
        parts = batch.parts
        if parts.switch is not None:
            raise ConfigurationError(
                f"teacher.planner is {teacher}; allowed: null for a switch, which chooses planners"
            )
        if batch.worlds > _FIRST_SEED:
            raise ConfigurationError(
                f"training.optimization.environments is {batch.worlds}; allowed: {_FIRST_SEED} at most with a teacher"
            )
        self.batch = batch
        composed = compose([f"planner={teacher}", f"robot={robot}"], hydra=True)
        self.untuned = missing_tunings(composed.hydra.runtime.choices, registry.manager)
        nodes = self.nodes = {kind: to_plain(composed[kind]) for kind in ("planner", "local_map", "tracker")}
        self.node: dict[str, Any] = nodes["planner"]
        self.plugin = registry.component("planner", self.node["name"]).plugin
        period = parts.robot.control_period * parts.settings.every

        def make_driver() -> Driver:
            with allowed_privileged(parts.config) as seeing:
                planner = registry.build("planner", nodes["planner"], robot=parts.robot)
                local_map = registry.build("local_map", nodes["local_map"], robot=parts.robot)
                tracker = (
                    None if parts.encoder.tracked else registry.build("tracker", nodes["tracker"], robot=parts.robot)
                )
            driver = Driver(parts.robot, Members({teacher: planner}), local_map, tracker, period)
            driver.privileged = [one.part for one in seeing]
            return driver

        self._drivers = [make_driver() for _ in range(batch.worlds)]

    def collect_rollout(
        self,
        actor: Actor,
        decisions: int,
        share: float,
        first_seed: int,
        decided: Callable[[int], None] = lambda decisions: None,
    ) -> ExpertRollout:
        """Drive new episodes for so many decisions, the first ``share`` of the worlds by the teacher, the rest by the
        policy.

        ``decided`` hears how many decisions are over.
        """
        batch, count = self.batch, self.batch.worlds
        seen, shown = [], []
        by_teacher = np.arange(count) < round(share * count)
        ends: Counter[str] = Counter()
        now = batch.reset([first_seed + k for k in range(count)])
        places = [(batch.seen, slot) for slot in range(count)]
        self._begin_drivers(range(count))
        for decision in range(decisions):
            interrupts.check()
            decided(decision)
            commands = np.array([driver.drive(0, *place) for driver, place in zip(self._drivers, places, strict=True)])
            wanted = batch.parts.scale.actions(commands).astype(np.float32)
            seen.append(now.copy())
            shown.append(wanted)
            step = batch.step(np.where(by_teacher[:, None], wanted, actor.act(now)))
            now, places = step.observations, [(batch.seen, slot) for slot in range(count)]
            ended = np.flatnonzero(step.terminated | step.truncated)
            ends.update(episode_outcome(step, slot) for slot in ended.tolist())
            if len(ended):
                now[ended] = batch.restart(ended)
                for row, slot in enumerate(ended.tolist()):
                    places[slot] = (batch.seen, row)
                self._begin_drivers(ended.tolist())
        decided(decisions)
        return ExpertRollout(np.concatenate(seen), np.concatenate(shown), ends)

    def _begin_drivers(self, slots: range | list[int]) -> None:
        for slot in slots:
            self._drivers[slot].begin(self.batch.episodes[slot].problem, self.batch.truth(slot))


def imitate_expert(
    learner: PPO,
    classroom: ImitationWorlds,
    settings: ExpertSettings,
    seed: int,
    folder: Path,
    report: TrainingReport | None = None,
) -> None:
    """Let the learner's policy imitate the teacher for all rounds that ``folder`` does not hold yet; each
    is kept there when it is over.
    """
    actor, report = Actor(learner.policy), report or TrainingReport(0)  # one that no one has started shows nothing
    optimizer = torch.optim.Adam(actor.parameters(), lr=settings.learning_rate)
    done = _load_progress(folder, actor, optimizer)
    lessons = [_read_rollout(_rollout_file(folder, number)) for number in range(done)] if done < settings.rounds else []
    pace = ImitationPace(settings.rounds, settings.decisions)
    for number in range(done, settings.rounds):
        share = 1.0 - number / max(settings.rounds - 1, 1)
        first_seed = (
            seed * SEEDS_APART + _FIRST_SEED + number % (_FIRST_SEED // classroom.batch.worlds) * classroom.batch.worlds
        )
        report.start_lesson(number + 1, settings.rounds, pace, settings.decisions)
        heard = _decisions_timed(report, pace)
        lesson = classroom.collect_rollout(actor, settings.decisions, share, first_seed, heard)
        _write_rollout(_rollout_file(folder, number), lesson)
        lessons.append((lesson.seen, lesson.shown))
        left, begun = 1.0 - number / settings.rounds, time.monotonic()
        loss = fit_imitation(
            actor,
            optimizer,
            lessons,
            settings,
            left,
            random_generator(training_seed(seed), f"lesson/{number}", "minibatches"),
        )
        pace.learned(time.monotonic() - begun, number + 1)
        if not all_finite(learner):
            rate = f"teacher.learning_rate is {settings.learning_rate:g}"
            raise ConfigurationError(
                f"{rate}, and the loss of lesson {number + 1} is no number; allowed: a smaller one, with out=DIR"
            )
        print(
            f"lesson {number + 1} of {settings.rounds}, {_describe_rollout(lesson, share)}; "
            f"off by {loss:.3f} of half the action's range",
            flush=True,
        )
        _save_progress(folder, actor, optimizer, number + 1)
    shutil.rmtree(folder / ROLLOUTS_FOLDER, ignore_errors=True)


def _decisions_timed(report: TrainingReport, pace: ImitationPace) -> Callable[[int], None]:
    """Return what shows how many decisions of a lesson are over, and takes in what each took."""
    last = time.monotonic()

    def show(decisions: int) -> None:
        nonlocal last
        now = time.monotonic()
        if decisions:
            pace.drove(now - last)
        last = now
        report.update_side_task(decisions)

    return show


def _describe_rollout(lesson: ExpertRollout, share: float) -> str:
    total = max(sum(lesson.ends.values()), 1)
    ends = ", ".join(
        f"{kind.replace('_', ' ')} {lesson.ends[kind] / total:.2f}"
        for kind in ("goal_reached", "collision", "time_out")
    )
    return f"the teacher drives {share:.2f} of the worlds: {ends} of {total}"


def fit_imitation(
    actor: ImitatingNetwork,
    optimizer: torch.optim.Optimizer,
    lessons: list[tuple[Rows, Rows]],
    settings: ExpertSettings,
    left: float,
    random: np.random.Generator,
) -> float:
    """Learn from all lessons ``settings.epochs`` times; return how far off it was the last time.

    That is a mean of absolute values, in halves of the actions' ranges. It is what is made small, not the mean square:
    where a teacher goes round something on the left or on the right, the mean of both drives into it, the median goes
    one way.
    """
    device = next(actor.parameters()).device
    seen, shown = (torch.from_numpy(np.concatenate(parts)).to(device) for parts in zip(*lessons, strict=True))
    for group in optimizer.param_groups:
        group["lr"] = settings.learning_rate * max(left, 0.1)
    total = 0.0
    for _ in range(settings.epochs):
        interrupts.check()
        total = 0.0
        order = torch.from_numpy(random.permutation(len(seen))).to(device)
        for first in range(0, len(order), settings.minibatch):
            chosen = order[first : first + settings.minibatch]
            off = actor.action_means(seen[chosen]) - shown[chosen]
            loss = off.abs().mean()
            optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            optimizer.step()
            total += float(loss.detach()) * len(chosen)
    return total / len(seen)


def _rollout_file(folder: Path, number: int) -> Path:
    return folder / ROLLOUTS_FOLDER / f"{number}.npz"


def _write_rollout(file: Path, lesson: ExpertRollout) -> None:
    content = io.BytesIO()
    np.savez(content, seen=lesson.seen, shown=lesson.shown)
    write_bytes_whole(file, content.getvalue())


def _read_rollout(file: Path) -> tuple[Rows, Rows]:
    with checkpoint_errors(file), np.load(io.BytesIO(file.read_bytes()), allow_pickle=False) as content:
        return content["seen"], content["shown"]


def _save_progress(folder: Path, actor: Actor, optimizer: torch.optim.Optimizer, rounds: int) -> None:
    content = io.BytesIO()
    torch.save({"rounds": rounds, "actor": actor.state_dict(), "optimizer": optimizer.state_dict()}, content)
    write_bytes_whole(folder / IMITATED_FILE, content.getvalue())


def load_imitation(folder: Path, actor: Actor) -> int:
    """Give the policy what a folder's lessons have taught it; return how many there were."""
    return _load_progress(folder, actor, torch.optim.Adam(actor.parameters()))


def _load_progress(folder: Path, actor: Actor, optimizer: torch.optim.Optimizer) -> int:
    """Give the policy what a folder's lessons have taught it; return how many there were."""
    file = folder / IMITATED_FILE
    if not file.exists():
        return 0
    with checkpoint_errors(file):
        content = torch.load(file, weights_only=True, map_location="cpu")
        actor.load_state_dict(content["actor"])
        optimizer.load_state_dict(content["optimizer"])
        return int(content["rounds"])
