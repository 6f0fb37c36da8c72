"""Teammates that were heard of, among the tracks: what planners see of messages without knowing of any."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from arena_core.values.geometry import FloatArray
from arena_core.values.messages import Message
from arena_core.values.sensing import Tracks

FIRST_HEARD = 1_000_000_000  # the track of teammate m has this number and m more: no tracker counts so far
ACCELERATION_DENSITY = 0.5  # m^2/s^3 of white-noise acceleration since a message was told, as tracker=kalman has it
WITHIN = 0.5  # share of a track's radius by which its centre may lie outside a teammate that it shows


def add_heard(tracks: Tracks, heard: Sequence[Message], stamp: float) -> Tracks:
    """Return the tracks at ``stamp`` (s) with a track for each teammate that was heard of, in place of what the tracker
    makes of its body.

    A teammate is a disc that has gone on at its velocity since it told of itself. The track of a body whose centre lies
    in it, or outside by less than half of the track's radius, is left out: no body but its own is there.
    """
    if not heard:
        return tracks
    told = _tracks_of(heard, stamp)
    apart = np.hypot(*(tracks.positions[:, None] - told.positions).transpose(2, 0, 1))
    kept = ~(apart < told.radii + WITHIN * tracks.radii[:, None]).any(axis=1)  # a track at NaN is nobody's
    return Tracks(
        np.concatenate((tracks.ids[kept], told.ids)),
        np.concatenate((tracks.positions[kept], told.positions)),
        np.concatenate((tracks.velocities[kept], told.velocities)),
        np.concatenate((tracks.radii[kept], told.radii)),
        np.concatenate((tracks.covariances[kept], told.covariances)),
    )


def _tracks_of(heard: Sequence[Message], stamp: float) -> Tracks:
    ages = np.array([stamp - message.stamp for message in heard])
    poses = np.array([message.pose.array() for message in heard])
    twists = np.array([message.twist.array() for message in heard])
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    velocities = np.column_stack((c * twists[:, 0] - s * twists[:, 1], s * twists[:, 0] + c * twists[:, 1]))
    return Tracks(
        np.array([FIRST_HEARD + message.sender for message in heard], np.int32),
        poses[:, :2] + velocities * ages[:, None],
        velocities,
        np.array([message.radius for message in heard]),
        _covariances(np.array([message.covariance[:2, :2] for message in heard]), ages),
    )


def _covariances(told: FloatArray, ages: FloatArray) -> FloatArray:
    """Return covariances (K, 4, 4) of places with (K, 2, 2) that accelerate by chance since ``ages`` (K,) s."""
    grown = np.zeros((len(ages), 4, 4))
    grown[:, :2, :2] = told
    for axis in range(2):
        grown[:, axis, axis] += ACCELERATION_DENSITY * ages**3 / 3.0
        grown[:, axis + 2, axis + 2] = ACCELERATION_DENSITY * ages
        grown[:, axis, axis + 2] = grown[:, axis + 2, axis] = ACCELERATION_DENSITY * ages**2 / 2.0
    return grown
