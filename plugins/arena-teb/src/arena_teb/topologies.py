"""Several bands of distinct topologies, kept alive from step to step, of which one is chosen (RAS 2017, section 5)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from arena_core import wrap_angle
from arena_kernels.compiled import TypedDispatch
from arena_kernels.costmap_window import Outline
from arena_teb.band import FirstDrive, band_along, band_duration, prune_band
from arena_teb.clusters import cluster_points
from arena_teb.columns import THETA, VX, WZ, X, Y
from arena_teb.feasibility import free_poses
from arena_teb.model import selection_penalties
from arena_teb.optimisation import Model, band_cost, optimise_band
from arena_teb.parameters import Homotopy, Trajectory
from arena_teb.problem import Ends, FloatArray
from arena_teb.roadmap import Roadmap, draw_samples, find_new_lines
from arena_teb.signature import h_signature, same_class
from arena_teb.surroundings import Scene


@dataclass(frozen=True, slots=True, eq=False)
class Topology:
    """A band of one class; ``initial``: the global path's class; ``blocked``: it runs into something
    static; ``cost`` for the choice.
    """

    band: FloatArray
    angles: FloatArray
    initial: bool
    blocked: bool = False
    cost: float = math.inf


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """What bands lead along: the local plan (M, 3), from pose ``start`` (3,) to pose ``goal`` (3,)."""

    plan: FloatArray
    start: FloatArray
    goal: FloatArray


class Topologies:
    """The bands of a planner, the chosen one first."""

    def __init__(self, homotopy: Homotopy, trajectory: Trajectory, model: Model, outline: Outline) -> None:
        self._homotopy = homotopy
        self._trajectory = trajectory
        self._model = model
        self._outline = outline
        self._selection = selection_penalties(model.penalties, homotopy.selection_obst_cost_scale)
        speed, turn = float(model.penalties.speed_max[VX]), float(model.penalties.speed_max[WZ])
        self._roadmap = Roadmap(
            outline.inscribed_radius, model.penalties.dynamic_near, speed, homotopy.obstacle_heading_threshold
        )
        self._drive = FirstDrive(speed, turn, trajectory.allow_init_with_backwards_motion)
        self._random = np.random.default_rng(0)
        self._optimised, self._band_cost, self._new_ways = (
            TypedDispatch(optimise_band),
            TypedDispatch(band_cost),
            TypedDispatch(find_new_lines),
        )
        self._cluster_points, self._signature, self._free_poses = (
            TypedDispatch(cluster_points),
            TypedDispatch(h_signature),
            TypedDispatch(free_poses),
        )
        self.clear()

    def begin(self, random: np.random.Generator) -> None:
        """Forget all bands and draw from ``random`` from now on."""
        self._random = random
        self.clear()

    def clear(self) -> None:
        """Forget all bands."""
        self._kept: list[Topology] = []
        self._goal: FloatArray | None = None
        self._switched_at = -math.inf

    def plan(self, way: Way, scene: Scene, ends: Ends, stamp: float) -> list[Topology]:
        """Return optimised bands along a way, the one to drive first."""
        points = self._cluster_points(
            scene.window, self._outline.inscribed_radius, way.start[X], way.start[Y], self._homotopy.max_clusters
        )
        explored = self._explore_classes(self._renew_bands(way, points, scene), way, points, scene)
        solved = [self._optimise_topology(topology, scene, ends) for topology in explored]
        self._kept = self._order_bands(solved, stamp)
        return self._kept

    def _renew_bands(self, way: Way, points: FloatArray, scene: Scene) -> list[Topology]:
        """Return the bands of the step before from the new start to the new goal, one a class;
        none when the goal has jumped.
        """
        before, self._goal = self._goal, way.goal
        if before is None or self._has_goal_jumped(before, way.goal):
            return []
        renewed: list[Topology] = []
        for topology in self._kept:
            band = prune_band(topology.band, way.start, way.goal, self._trajectory.min_samples)
            angles = self._signature(band, points, scene.foreseen, scene.horizon)
            if not any(same_class(angles, other.angles) for other in renewed):
                renewed.append(replace(topology, band=band, angles=angles, initial=False))
        return renewed

    def _has_goal_jumped(self, before: FloatArray, goal: FloatArray) -> bool:
        moved = math.hypot(goal[X] - before[X], goal[Y] - before[Y])
        turned = abs(float(wrap_angle(goal[THETA] - before[THETA])))
        return (
            moved > self._trajectory.force_reinit_new_goal_dist
            or turned > self._trajectory.force_reinit_new_goal_angular
        )

    def _explore_classes(self, known: list[Topology], way: Way, points: FloatArray, scene: Scene) -> list[Topology]:
        """Return the known bands, the global path's if its class is new, and new ones from the roadmap."""
        start, goal = way.start, way.goal
        initial = band_along(way.plan[:-1, :2], start, goal, self._drive)
        angles = self._signature(initial, points, scene.foreseen, scene.horizon)
        same = [same_class(angles, topology.angles) for topology in known]
        found = [replace(topology, initial=like) for topology, like in zip(known, same, strict=True)]
        most = self._homotopy.max_number_classes
        if not any(same):
            blocked = self._is_blocked(initial, scene)
            found = (
                [*found[: max(most - 1, 0)], Topology(initial, angles, True, blocked)]
                if most > 1 or not found
                else found
            )
        wanted = most - len(found)
        if wanted <= 0 or math.hypot(goal[X] - start[X], goal[Y] - start[Y]) < 2.0 * self._outline.radius:
            return found
        drawn = draw_samples(
            self._random, self._homotopy.roadmap_graph_no_samples, start, goal, self._homotopy.roadmap_graph_area_width
        )
        # a band through an obstacle counts for no class: which side of the obstacle's point it runs on says nothing
        known_angles = [topology.angles for topology in found if not topology.blocked]
        classes = np.array(known_angles).reshape(len(known_angles), len(angles))
        lines, signatures = self._new_ways(start, goal, drawn, scene, points, classes, wanted, self._roadmap)
        ways = zip(lines, signatures, strict=True)
        return found + [Topology(band_along(line, start, goal, self._drive), angles, False) for line, angles in ways]

    def _optimise_topology(self, topology: Topology, scene: Scene, ends: Ends) -> Topology:
        band, _, _ = self._optimised(topology.band, scene, self._model, ends)
        cost = self._band_cost(band, scene, self._selection, self._model, ends)
        return replace(topology, band=band, cost=cost, blocked=self._is_blocked(band, scene))

    def _is_blocked(self, band: FloatArray, scene: Scene) -> bool:
        return self._free_poses(band, scene.window, self._outline, 0.0, 0.0) < len(band)

    def _order_bands(self, solved: list[Topology], stamp: float) -> list[Topology]:
        """Return the bands in the order of their costs without detours; the one driven before and
        the global path's count for less.
        """
        homotopy = self._homotopy
        finite = [topology for topology in solved if np.isfinite(topology.band).all()]
        if not finite:
            return []
        driven = finite[0] if self._kept and finite[0] is solved[0] else None

        def rank(topology: Topology) -> tuple[bool, float]:
            cost = topology.cost * (homotopy.selection_prefer_initial_plan if topology.initial else 1.0)
            return topology.blocked, cost * (homotopy.selection_cost_hysteresis if topology is driven else 1.0)

        order = sorted(finite, key=rank)
        recent = stamp - self._switched_at < homotopy.switching_blocking_period
        if driven is not None and order[0] is not driven:
            if recent and not driven.blocked:
                order = [driven, *(topology for topology in order if topology is not driven)]
            else:
                self._switched_at = stamp
        longest = homotopy.max_ratio_detours_duration_best_duration * band_duration(order[0].band)
        return order[:1] + [
            topology for topology in order[1:] if band_duration(topology.band) <= longest and not topology.blocked
        ]
