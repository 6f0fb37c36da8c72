"""Speed of the nonlinear program of model predictive control: shooting, as the planner drives it, against
ipopt on the same problems.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from time import process_time
from typing import Any

import numpy as np

from arena_mpc.arrays import FloatArray
from arena_mpc.columns import STAGE_HEAD
from arena_mpc.corridor import FREE
from arena_mpc.guess import drive_along, shift_plan
from arena_mpc.moving import FAR
from arena_mpc.objective import WEIGHTS
from arena_mpc.parameters import SolverSettings
from arena_mpc.plan import Plan, Room
from arena_mpc.problem import Shape
from arena_mpc.solvers import InteriorPoint, Shooting, Solver
from arena_mpc.terms import Terms

SHAPE = Shape("unicycle", "minimum_time", 20, 1, 3, 5, cells=False, hard=False, fixed_end=False)
LARGE = replace(SHAPE, stages=30, movers=10)
SHOOTING, IPOPT = SolverSettings("shooting", 60, 60, 1e-3), SolverSettings("ipopt", 60, 60, 1e-3)
SPEED, TURN, PERIOD, STEP = 1.0, 1.5, 0.1, 0.15  # m/s, rad/s, s, s
ROOM = Room(np.array((-0.2, -TURN)), np.array((SPEED, TURN)), np.full(2, 4.0), 0.02, 0.5, 1.0)
TUNED = {"time": 1.0, "goal_position": 100.0, "path": 2.0, "acceleration_linear": 0.01, "acceleration_angular": 0.01}
WEIGHED = np.array(
    [{**TUNED, "goal_heading": 0.5, "slack": 10.0, "slack_squared": 100.0}.get(name, 0.0) for name in WEIGHTS]
)
GAP = 0.7  # m, between the robot's centre and a person's
HALF = 4.0  # m, half the side of the square that people walk in
AHEAD = 2.5  # m
EVERY = 10  # ipopt solves every tenth problem


@dataclass(slots=True)
class Drive:
    """What a closed loop measures: CPU seconds of shooting and, on some of the same problems, of ipopt;
    failures; costs that differ.
    """

    shooting: list[float]
    ipopt: list[float]
    failures: int


def closed_loop(shape: Shape, steps: int, seed: int = 0) -> Drive:
    """Drive to and fro among walking people for ``steps`` control steps."""
    ours, peer = Shooting(SHOOTING), InteriorPoint(IPOPT, lambda _: shape)
    peer.prepare(shape.stages)
    generator = np.random.default_rng(seed)
    people = np.column_stack(
        (generator.uniform(-HALF, HALF, (shape.movers, 2)), generator.uniform(-0.4, 0.4, (shape.movers, 2)))
    )
    people[np.hypot(*people[:, :2].T) < 1.5, :2] += 2.0
    state, target, plan, drive = np.zeros(5), HALF, None, Drive([], [], 0)
    for k in range(steps):
        if abs(target - state[0]) < 0.3:
            target, plan = -target, None
        path = _straight_path(state, target)
        guess = _shift_plan(plan, path[-1], state) if plan is not None else _plan_along(path, state, shape.stages)
        terms = _make_terms(shape, path, people)
        plan = _timed_solution(ours, terms, state, guess, drive.shooting)
        if k % EVERY == 0:
            _timed_solution(peer, terms, state, guess, drive.ipopt)
        drive.failures += plan is None
        state = state if plan is None else _advance_state(state, plan)
        people[:, :2] += PERIOD * people[:, 2:]
        people[:, 2:] *= np.where(np.abs(people[:, :2]) > HALF, -np.sign(people[:, :2] * people[:, 2:]), 1.0)
    return drive


def _straight_path(state: FloatArray, target: float) -> FloatArray:
    """Return the way along the x axis towards ``target``, at most AHEAD m of it."""
    end = state[0] + min(max(target - state[0], -AHEAD), AHEAD)
    xs = np.linspace(state[0], end, 26)
    return np.column_stack((xs, np.zeros(26), np.full(26, 0.0 if end > state[0] else math.pi)))


def _plan_along(path: FloatArray, state: FloatArray, stages: int) -> Plan:
    rolled = drive_along(path, state[:3].copy(), SPEED, TURN, False, 0.0, stages, STEP)
    states = rolled[:, (0, 1, 2, 3, 5)]
    states[0] = state
    return Plan(states, STEP, np.zeros(stages + 1))


def _shift_plan(plan: Plan, goal: FloatArray, state: FloatArray) -> Plan:
    end, stages = plan.states[-1].copy(), len(plan.states) - 1
    end[:2] = goal[:2]
    states = shift_plan(plan.states, plan.step, PERIOD, end, stages, plan.step)
    states[0] = state
    return Plan(states, plan.step, plan.slack)


def _make_terms(shape: Shape, path: FloatArray, people: FloatArray) -> Terms:
    """Return the numbers of a problem between two walls, 3 m to the left and right."""
    movers = np.column_stack((people, np.full(len(people), GAP))) if len(people) else np.full((shape.movers, 5), FAR)
    row = np.zeros(shape.stage_row)
    row[:6] = (path[0, 0], 0.0, 0.0, 1.0, path[0, 2], 1.0)
    row[STAGE_HEAD:] = (0.0, 1.0, -3.0, 0.0, -1.0, -3.0, 0.0, 0.0, FREE)
    rows = np.tile(row, (shape.stages + 1, 1))
    return Terms(0, True, 1.0, STEP, 0.02, 0.0, 1.0, path[-1].copy(), WEIGHED, np.zeros((1, 2)), movers, rows)


def _timed_solution(solver: Solver, terms: Terms, state: FloatArray, guess: Plan, seconds: list[float]) -> Plan | None:
    began = process_time()
    found = solver.solve(terms, state, guess, ROOM, SHOOTING.max_iterations)
    seconds.append(process_time() - began)
    return None if found is None else found.plan


def _advance_state(state: FloatArray, plan: Plan) -> FloatArray:
    """Return the state after a control period at the plan's first velocities."""
    v, omega = plan.states[1, 3:]
    middle = state[2] + 0.5 * PERIOD * omega
    x, y = state[0] + PERIOD * v * math.cos(middle), state[1] + PERIOD * v * math.sin(middle)
    return np.array((x, y, state[2] + PERIOD * omega, v, omega))


def measure() -> list[dict[str, Any]]:
    """Return the median CPU time of a solution beside ipopt's, the failures of a long drive, and the 95th
    percentile of large problems.
    """
    closed_loop(SHAPE, 1)  # compiles
    usual, large = closed_loop(SHAPE, 500), closed_loop(LARGE, 200)
    ours, peer = float(np.median(usual.shooting)) * 1e3, float(np.median(usual.ipopt)) * 1e3
    p95 = float(np.quantile(large.shooting, 0.95)) * 1e3
    failed, slow = (
        "MPC, failures in 500 closed-loop steps, at most",
        "MPC, 30 intervals, 10 people, 95th percentile, at most",
    )
    solved = {"what": "MPC, 20 intervals, 5 people: one solution", "ours_ms": ours, "peer": "ipopt", "peer_ms": peer}
    none = {"peer": None, "peer_ms": None, "ratio": None}
    return [
        {**solved, "ratio": ours / peer, "goal": 0.4, "unit": "x peer"},
        {"what": failed, "ours_ms": float(usual.failures), **none, "goal": 0.0, "unit": "steps", "ours_unit": "steps"},
        {"what": slow, "ours_ms": p95, **none, "goal": 12.0, "unit": "ms"},
    ]


if __name__ == "__main__":
    for row in measure():
        peer = f"{row['peer']} {row['peer_ms']:.3f} ms, ratio {row['ratio']:.3f}" if row["peer"] else ""
        print(
            f"{row['what']:62} {row['ours_ms']:.3f} {row.get('ours_unit', 'ms')}  {peer:36} goal "
            f"{row['goal']:.3f} {row['unit']}"
        )
