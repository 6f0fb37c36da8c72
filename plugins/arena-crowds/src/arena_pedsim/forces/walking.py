"""Moving the bodies of one world: where everybody gets to, and with what velocity."""

from __future__ import annotations

from math import isnan

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.crowds import NearPairs
from arena_kernels.slide_along import slide_along
from arena_pedsim.crowd_scene import CrowdScene, Step
from arena_pedsim.forces.acceleration import clip_length
from arena_pedsim.forces.contact_forces import push_by_mass
from arena_pedsim.forces.yielding import keeps_distance

Floats = NDArray[np.float64]

ABSENT = -1.0  # in ``starts``: this person is nowhere

# no wall is met on a move of half the gap: the interpolated field rises a little more steeply than a distance
FREE_STRIDE = 2.0


@compiled
def move_bodies(scene: CrowdScene, step: Step, near: NearPairs, starts: Floats, pushes: Floats) -> None:
    """Move the bodies, apart from each other and out of walls; a body that was hindered has the velocity it really
    moved with.

    ``starts`` (P, 4) comes with the gap to the walls in its last column; it and ``pushes`` (P, 2) are overwritten.
    """
    positions, velocities, radii, _ = scene.bodies
    for i in range(len(positions)):
        x, y, dx, dy = positions[i, 0], positions[i, 1], step.dt * velocities[i, 0], step.dt * velocities[i, 1]
        if isnan(x):
            starts[i, 2] = ABSENT
            continue
        if starts[i, 3] > FREE_STRIDE * scene.people[i].max_speed * step.dt:
            positions[i, 0], positions[i, 1] = x + dx, y + dy
        else:
            positions[i, 0], positions[i, 1] = slide_along(scene.ground, (x, y, radii[i]), dx, dy)
        starts[i, 0], starts[i, 1] = x, y
        starts[i, 2] = 1.0 if positions[i, 0] != x + dx or positions[i, 1] != y + dy else 0.0
    touching = push_by_mass(positions, radii, scene.people, near, pushes)
    for i in range(len(positions)):
        if starts[i, 2] == ABSENT:
            continue
        if touching and (pushes[i, 0] != 0.0 or pushes[i, 1] != 0.0):
            dx, dy = positions[i, 0] + pushes[i, 0] - starts[i, 0], positions[i, 1] + pushes[i, 1] - starts[i, 1]
            dx, dy = clip_length(dx, dy, scene.people[i].max_speed * step.dt)
            positions[i, 0], positions[i, 1] = slide_along(scene.ground, (starts[i, 0], starts[i, 1], radii[i]), dx, dy)
            starts[i, 2] = 1.0
        if scene.people[i].gives_way == 1 and not keeps_distance(
            (starts[i, 0], starts[i, 1], radii[i]), positions[i, 0], positions[i, 1], scene.robots, step.parameters
        ):
            positions[i, 0], positions[i, 1] = starts[i, 0], starts[i, 1]
            starts[i, 2] = 1.0
        if starts[i, 2] == 1.0:
            vx, vy = (positions[i, 0] - starts[i, 0]) / step.dt, (positions[i, 1] - starts[i, 1]) / step.dt
            velocities[i, 0], velocities[i, 1] = clip_length(vx, vy, scene.people[i].max_speed)
