"""People on two legs, as a lidar at the height of their shins sees them: two discs, in step with the way that they
cover.

The two legs of a person are as far ahead of the body as behind it. A foot on the ground stays where it is while the
body moves on by a step, the other one meanwhile comes forward by two: along the way both offsets are triangle waves of
the way covered, not of time.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from arena_kernels.compiled import inner

STANDING = 1e-4  # m/s; who stands keeps so much of the last velocity, that is the direction in which the person looks
Velocity = tuple[float, float]
Legs = tuple[float, float, float, float, float]


class Gait(NamedTuple):
    """How people walk; lengths in m, speeds in m/s, ``walk_ratio`` in m min, ``apart`` a share
    of a step, ``settling`` in s.
    """

    leg_radius: float
    stance_width: float
    step_width: float
    step_width_from: float
    walk_ratio: float
    apart: float
    settling: float


@inner
def step_length(gait: Gait, pace: float) -> float:
    """Return how long a step is at a pace, m: steps get longer and quicker alike (Sekiya and Nagasaki
    1998), so as its square root.
    """
    return math.sqrt(60.0 * gait.walk_ratio * max(pace, STANDING))


@inner
def smooth_velocity(gait: Gait, velocity: Velocity, wanted: Velocity, dt: float) -> Velocity:
    """Return the velocity that the legs have taken up ``dt`` s later; it never vanishes, so that
    who stands looks somewhere.
    """
    share = 1.0 - math.exp(-dt / gait.settling)
    x, y = velocity[0] + share * (wanted[0] - velocity[0]), velocity[1] + share * (wanted[1] - velocity[1])
    if x * x + y * y >= STANDING * STANDING:
        return x, y
    pace = math.sqrt(velocity[0] * velocity[0] + velocity[1] * velocity[1])
    return velocity[0] * STANDING / pace, velocity[1] * STANDING / pace


@inner
def legs_of(gait: Gait, x: float, y: float, radius: float, velocity: Velocity, steps: float) -> Legs:
    """Return the centres (x, y) of the left and of the right leg and their radius, m, all within the body's disc.

    ``velocity`` is what the legs have taken up (``smooth_velocity``), ``steps`` how many steps the person has walked.
    """
    pace = math.sqrt(velocity[0] * velocity[0] + velocity[1] * velocity[1])
    cosine, sine = velocity[0] / pace, velocity[1] / pace
    leg = min(gait.leg_radius, 0.5 * radius)
    narrow = min(pace / gait.step_width_from, 1.0)
    side = min(0.5 * (gait.stance_width + narrow * (gait.step_width - gait.stance_width)), radius - leg)
    room = math.sqrt((radius - leg) * (radius - leg) - side * side)
    ahead = _leg_swing(steps) * min(0.5 * gait.apart * step_length(gait, pace), room)
    along_x, along_y, aside_x, aside_y = ahead * cosine, ahead * sine, -side * sine, side * cosine
    return x + along_x + aside_x, y + along_y + aside_y, x - along_x - aside_x, y - along_y - aside_y, leg


@inner
def _leg_swing(steps: float) -> float:
    """Return where the left leg is, 1 at the front after an even number of steps, -1 at the back after an
    odd one, straight between.
    """
    return abs(2.0 * (steps - 2.0 * math.floor(0.5 * steps)) - 2.0) - 1.0
