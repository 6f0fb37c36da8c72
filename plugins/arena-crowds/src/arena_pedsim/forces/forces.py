"""The accelerations of the social-force model, for one person or one pair."""

from __future__ import annotations

from math import atan2, exp, sqrt
from typing import Any

from arena_kernels.compiled import compiled

NEGLIGIBLE = 7.0  # a gap of this many interaction lengths leaves exp(-7) < 0.1 % of the force


@compiled
def social_force(
    dx: float, dy: float, dvx: float, dvy: float, radii: float, parameters: Any
) -> tuple[float, float, float, float]:
    """Return the force on a person from another at (dx, dy), and the unit vector towards it; the other feels the
    opposite force.

    ``dvx, dvy`` is the person's velocity less the other's, ``radii`` the sum of both radii: the force decays with the
    gap between the bodies. Moussaid et al., Experimental study of the behavioural mechanisms underlying
    self-organization in human crowds, Proc. R. Soc. B 276, 2009, equations 3 to 6.
    """
    separation = sqrt(dx * dx + dy * dy)
    ex, ey = (dx / separation, dy / separation) if separation > 0.0 else (1.0, 0.0)
    ix, iy = parameters.social_lambda_importance * dvx + ex, parameters.social_lambda_importance * dvy + ey
    length = sqrt(ix * ix + iy * iy)
    reach = parameters.social_gamma * length
    gap = max(separation - radii, 0.0)
    if gap >= NEGLIGIBLE * reach:
        return 0.0, 0.0, ex, ey
    tx, ty = ix / length, iy / length
    theta = atan2(tx * ey - ty * ex, tx * ex + ty * ey) + parameters.social_epsilon * reach
    braking = (parameters.social_n_prime * reach * theta) ** 2
    turning = (parameters.social_n * reach * theta) ** 2
    along = -exp(-gap / reach - braking)
    across = -exp(-gap / reach - turning) if theta > 0.0 else exp(-gap / reach - turning)
    return along * tx - across * ty, along * ty + across * tx, ex, ey


@compiled
def sight_weight(heading_x: float, heading_y: float, ex: float, ey: float, rear_weight: float) -> float:
    """Return how much what lies in direction (ex, ey) counts: 1 ahead, ``rear_weight`` behind.

    Johansson, Helbing, Shukla, Specification of the social force pedestrian model by evolutionary adjustment to video
    tracking data, Advances in Complex Systems 10, 2007, equation 5.
    """
    return rear_weight + (1.0 - rear_weight) * 0.5 * (1.0 + heading_x * ex + heading_y * ey)


@compiled
def wall_force(gap: float, parameters: Any) -> float:
    """Return the size of a wall's repulsion at this gap (m) between body and wall."""
    if gap >= parameters.walls_range:
        return 0.0
    limit: float = parameters.walls_limit
    if parameters.walls_form == 0:
        return min(exp(-max(gap, 0.0) / parameters.walls_sigma), limit)
    return limit if gap * limit < 1.0 else 1.0 / gap
