"""What a training is going to do, in lines: lessons, steps, validations, test."""

from __future__ import annotations

from collections.abc import Iterator

from arena_gym.training.settings import TrainingSettings


def final_steps(settings: TrainingSettings, done: int = 0) -> int:
    """Return the steps after which a training ends that goes on from ``done``: ``total_steps``, or the few more with
    which all worlds have made as many.
    """
    worlds = settings.optimization.environments
    return done + max(0, -(-(settings.total_steps - done) // worlds)) * worlds


def describe_plan(settings: TrainingSettings, done: int, *, taught: bool) -> Iterator[str]:
    """Yield what is going to be done, from ``done`` steps on; lessons are over where it has been ``taught``."""
    chosen, teacher = settings.optimization, settings.teacher
    if teacher.planner is not None and not taught:
        yield (
            f"lessons: {teacher.rounds} of {teacher.decisions} decisions in each of {chosen.environments} worlds, "
            f"of {teacher.planner}"
        )
    total, rollout = final_steps(settings, done), chosen.environments * chosen.steps
    unlike = (
        ""
        if total == settings.total_steps or total == done
        else f"; total_steps={settings.total_steps} is no multiple of the worlds"
    )
    already = f"{done} of them driven already, " if done else ""
    yield (
        f"training: {total} steps, {already}in rollouts of {rollout} ({chosen.environments} worlds, "
        f"{chosen.steps} steps){unlike}"
    )
    yield f"validations: {settings.validation.episodes} episodes every {settings.validation.every} steps and at the end"
    tested = settings.test.episodes
    yield f"test: {tested} episodes at the end (test=false: none)" if tested else "test: none"
