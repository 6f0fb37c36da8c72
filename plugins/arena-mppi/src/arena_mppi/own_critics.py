"""Critics of your own: a small class in Python that adds a cost to every roll-out, beside the compiled ones."""

from __future__ import annotations

import importlib
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, is_dataclass
from importlib.metadata import entry_points
from typing import Any

import numpy as np

from arena_core import ArenaError, ConfigurationError, Observation
from arena_core.parameters import read_settings
from arena_mppi.candidates import rollout_poses, rollout_velocities
from arena_mppi.critics import FAR
from arena_mppi.parameters import Doubles, Floats, Sampling, Scene, Workspace

GROUP = "arena_mppi.critics"  # of entry points: name = "module:Class"


@dataclass(frozen=True, slots=True, eq=False)
class Rollouts:
    """N roll-outs of T steps of ``dt`` s, the first after one step.

    ``poses`` (N, T, 3) of x, y (m) and heading (rad) in ``map``; ``velocities`` (N, T, 3) in ``base_link``, m/s and
    rad/s.
    """

    poses: Doubles
    velocities: Doubles
    dt: float


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """What roll-outs are judged against.

    ``observation`` is what the planner sees. ``people`` (T, P, 3) is where each moving obstacle is expected at each
    step, in ``map``, and its radius, m; ``belief`` (T,) is how sure that is, 1 .. 0.
    """

    observation: Observation
    people: Doubles
    belief: Doubles
    _scene: Scene

    def clearances(self, positions: Doubles) -> Doubles:
        """Return the distance of positions (..., 2) in ``map`` from the nearest wall, m; FAR outside the window."""
        window, gaps = self._scene.window, self._scene.gaps
        cells = np.floor((positions - (window.origin_x, window.origin_y)) / window.resolution).astype(np.int64)
        column, row = cells[..., 0], cells[..., 1]
        inside = (row >= 0) & (column >= 0) & (row < gaps.shape[0]) & (column < gaps.shape[1])
        return np.where(inside, gaps[np.where(inside, row, 0), np.where(inside, column, 0)], float(FAR))


class Critic(ABC):
    """Judges roll-outs. Write it as a frozen dataclass: its fields are its keys in ``planner.critics``.

    It is built once a run and keeps nothing from one control step to the next.
    """

    @abstractmethod
    def cost(self, rollouts: Rollouts, around: Surroundings) -> Doubles:
        """Return what each roll-out costs (N,): finite, not negative; 1e6 counts as a collision."""


def make_critics(nodes: Sequence[Mapping[str, Any]]) -> dict[str, Critic]:
    """Return the critics that ``planner.critics`` names, by their place and name; raise ConfigurationError."""
    return {
        f"critics[{k}] {node.get('name')}": _make_critic(node, f"mppi: critics[{k}]") for k, node in enumerate(nodes)
    }


def _make_critic(node: Mapping[str, Any], key: str) -> Critic:
    factory = _find_factory(node.get("name"), key)
    if not (isinstance(factory, type) and issubclass(factory, Critic) and is_dataclass(factory)):
        raise ConfigurationError(f"{key}.name is {node['name']}; allowed: a frozen dataclass that is a Critic")
    critic: Critic = read_settings({name: value for name, value in node.items() if name != "name"}, factory, key)
    return critic


def _find_factory(name: Any, key: str) -> Any:
    offered = {point.name: point for point in entry_points(group=GROUP)}
    try:
        if name in offered:
            return offered[name].load()
        module, colon, attribute = str(name).partition(":")
        if colon:
            return getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError) as error:
        raise ConfigurationError(f"{key}.name is {name}, which cannot be imported: {error}") from error
    allowed = ", ".join([*sorted(offered), "module:Class"])
    raise ConfigurationError(f"{key}.name is {name!r}; allowed: {allowed}")


def add_own_costs(
    critics: Mapping[str, Critic],
    work: Workspace,
    sampling: Sampling,
    scene: Scene,
    observation: Observation,
    now: Floats,
) -> None:
    """Add what the critics say to the costs of all roll-outs; raise ArenaError for what is no cost."""
    count, dt = sampling.batch_size, float(sampling.dt)
    velocities = rollout_velocities(work, sampling)[:count].astype(np.float64)
    rollouts = Rollouts(rollout_poses(velocities, observation.pose, now, dt)[:, 1:], velocities, dt)
    around = _surroundings_of(scene, observation)
    for name, critic in critics.items():
        costs = np.asarray(critic.cost(rollouts, around))
        _check_costs(name, costs, count)
        work.costs[:count] += costs.astype(np.float32)


def _surroundings_of(scene: Scene, observation: Observation) -> Surroundings:
    people = scene.moving.astype(np.float64)
    people[..., :2] += (scene.x, scene.y)
    return Surroundings(observation, people, scene.belief.astype(np.float64), scene)


def _check_costs(name: str, costs: Any, count: int) -> None:
    if costs.shape != (count,):
        raise ArenaError(f"mppi: {name} returned costs of shape {costs.shape}; allowed: ({count},)")
    if not (costs.dtype.kind in "fiu" and np.isfinite(costs).all() and costs.min() >= 0.0):
        raise ArenaError(f"mppi: {name} returned costs that are not finite or negative; allowed: numbers >= 0")
