"""What robots of a team tell each other."""

from __future__ import annotations

from dataclasses import dataclass

from arena_core.values.geometry import FloatArray, Pose, Twist


@dataclass(frozen=True, slots=True, eq=False)
class Message:
    """Where robot ``sender`` of a team believed to be at ``stamp`` (s), and how it moved.

    ``pose`` is its estimate in ``map``, with its ``covariance`` (3, 3) over x, y, theta, ``twist`` the measured
    velocity in its ``base_link``, ``radius`` (m) that of the circle about ``base_link`` that holds its outline.
    """

    sender: int
    stamp: float
    pose: Pose
    twist: Twist
    covariance: FloatArray
    radius: float
