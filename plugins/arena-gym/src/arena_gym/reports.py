"""What ``info`` says when an episode begins and ends."""

from __future__ import annotations

from typing import Any

from arena_gym.batch import NavigationBatch, Step


def start_report(batch: NavigationBatch, slot: int) -> dict[str, Any]:
    """Return the name of the problem, its people, the length of its path, m, and its level, if the task has any."""
    problem = batch.episodes[slot].problem
    report = {
        "scenario": problem.scenario.name,
        "people": len(problem.scenario.pedestrians),
        "path_length": float(problem.left[0]),
    }
    return report | _stage_info(batch, slot)


def final_report(batch: NavigationBatch, step: Step, slot: int) -> dict[str, Any]:
    """Return how an episode ended: outcome, collisions, control steps, and whether the goal was reached."""
    return {
        "outcome": episode_outcome(step, slot),
        "success": bool(step.arrived[slot]),
        "collisions": int(batch.collisions[slot]),
        "steps": int(batch.steps[slot]),
    } | _stage_info(batch, slot)


def _stage_info(batch: NavigationBatch, slot: int) -> dict[str, int]:
    stage = batch.episodes[slot].problem.scenario.stage
    return {} if stage is None else {"stage": stage}


def episode_outcome(step: Step, slot: int) -> str:
    """Return the outcome in the words of episodes.csv."""
    if step.arrived[slot]:
        return "goal_reached"
    if step.mistaken[slot]:
        return "false_arrival"
    return "collision" if step.terminated[slot] else "time_out"
