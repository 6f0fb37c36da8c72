"""The contract of every kind of component, as facts that are tried one after the other: which test is whose."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from arena_core.base.errors import ContractViolation
from arena_core.contracts.truth import BrainPart
from arena_core.testing import samples
from arena_core.testing.communication_checks import check_communication
from arena_core.testing.facts import Facts
from arena_core.testing.learning_checks import check_observation_encoder, check_reward
from arena_core.testing.navigation_checks import (
    check_global_planner,
    check_local_map,
    check_localizer,
    check_predictor,
    check_tracker,
    check_waypoints,
)
from arena_core.testing.planner_checks import check_planner
from arena_core.testing.running_checks import check_executor, check_metrics, echo_job
from arena_core.testing.simulation_checks import (
    check_pedestrians,
    check_robot,
    check_simulator,
    check_task,
    check_world,
)
from arena_core.values.robot import Robot

__all__ = ["CHECKS", "check", "echo_job"]

CHECKS: dict[str, Callable[[Any, Robot], Facts]] = {
    "planner": check_planner,
    "robot": check_robot,
    "world": check_world,
    "task": check_task,
    "localizer": check_localizer,
    "global_planner": check_global_planner,
    "waypoints": check_waypoints,
    "local_map": check_local_map,
    "tracker": check_tracker,
    "predictor": check_predictor,
    "communication": check_communication,
    "pedestrians": check_pedestrians,
    "simulator": check_simulator,
    "reward": check_reward,
    "observation_encoder": check_observation_encoder,
    "metrics": check_metrics,
    "executor": check_executor,
}


def check(kind: str, component: Any, body: Robot) -> list[str]:
    """Try every fact of a kind's contract and return them; raise ContractViolation at the first that does not hold."""
    held = []
    if isinstance(component, BrainPart) and component.privileged:
        component.see(samples.truth(body))
    for fact, holds in CHECKS[kind](component, body):
        if not holds:
            raise ContractViolation(f"{kind} {type(component).__name__}: not so: {fact}")
        held.append(fact)
    return held
