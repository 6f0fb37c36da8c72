"""The predictor that rolls tracked people on as the crowd's model would."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, Observation, OccupancyGrid, PedestrianModel, Predictions, Predictor, Tracks
from arena_core.parameters import Bounds, Fraction, Positive, PositiveInt
from arena_kernels.compiled import TypedDispatch
from arena_kernels.distance import distance_field
from arena_kernels.ground import Ground
from arena_pedsim.model import SocialForceModel
from arena_pedsim.prediction.rollout import Manners, Walkers, infer_wishes, roll_on

Floats = NDArray[np.float64]
Step = Annotated[float, Bounds(low=0.05, high=0.25)]  # s: half the time in which velocities are taken up
Horizon = Annotated[float, Bounds(low=0.25, high=20.0)]  # s


@dataclass(frozen=True, slots=True)
class ForceRules:
    """For how long forces are reckoned, ``horizon`` s in steps of ``step`` s; people push each other by a ``share`` of
    what those of the crowd do.
    """

    horizon: Horizon
    step: Step
    share: Fraction


@dataclass(frozen=True, slots=True)
class WishRules:
    """How a track tells what its person wants; times in s.

    A change of velocity is taken over ``acceleration_time``; wishes follow what is inferred in ``wish_time``; how fast
    a person wants to be is the fastest seen, forgotten in ``speed_time``. A track whose velocity is as unsure as
    ``doubt`` times that speed is trusted by half; one
    that is by ``steady`` times it is looked at for twice as long.
    """

    acceleration_time: Positive
    wish_time: Positive
    speed_time: Positive
    doubt: Positive
    steady: Positive


@dataclass(frozen=True, slots=True)
class WayRules:
    """How a way on is chosen, every ``look`` s: a wish turns by up to ``turns`` times ``turn`` rad to either side to
    where no wall stands for ``ahead`` s.
    """

    look: Positive
    ahead: Positive
    turn: Positive
    turns: PositiveInt


@dataclass(slots=True)
class Believed:
    """What is believed of K tracks: the velocities that they wish for, their velocities a while ago, the fastest."""

    ids: list[int]
    wishes: Floats
    before: Floats
    fastest: Floats


class SocialForcePredictor(Predictor):
    """Expect people to walk on by the forces of ``crowd``, social force among those who are tracked.

    What a person wants is inferred: with what desired velocity the forces give the track's velocity and its change. The
    wish turns aside where a wall ends its way. People push each other by less than those of the crowd, for what they
    want is known but roughly. After the horizon each keeps its velocity.
    """

    def __init__(self, crowd: PedestrianModel, reckoned: ForceRules, wishes: WishRules, ways: WayRules) -> None:
        if not isinstance(crowd, SocialForceModel):
            raise ConfigurationError(
                f"predictor.crowd is {type(crowd).__name__}; allowed: social_force, and presets of it"
            )
        self._step, self._rules = reckoned.step, wishes
        self._times = np.arange(round(reckoned.horizon / reckoned.step) + 1, dtype=np.float64) * reckoned.step
        factors = crowd.factors
        scale = 1.0 if factors.reference_speed is None else factors.reference_speed
        parameters = crowd.parameters[0]
        self._manners = Manners(
            parameters,
            float(parameters["relaxation_time"]) / max(factors.desired, 1e-6),
            reckoned.share * factors.social / scale,
            factors.obstacle / scale,
            ways.look,
            ways.ahead,
            ways.turn,
            ways.turns,
        )
        self._roll_on, self._infer = TypedDispatch(roll_on), TypedDispatch(infer_wishes)
        self.reset(None)

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode; nothing is believed of anybody."""
        self._ground = OPEN if grid is None else grid.derive(ground_of)
        nobody = np.empty((0, 2))
        self._believed, self._stamp = Believed([], nobody, nobody, np.empty(0)), -np.inf

    def predict(self, observation: Observation) -> Predictions:
        """Return where the tracks are after the next steps of the crowd."""
        tracks = observation.tracks
        count, known = len(tracks.ids), np.isfinite(tracks.positions).all(axis=1)
        rows = np.flatnonzero(known & np.isfinite(tracks.velocities).all(axis=1))
        self._believe(tracks, rows, observation.stamp)
        if not len(rows):
            return Predictions.straight(tracks.positions, tracks.velocities, tracks.covariances)
        walkers = self._walkers(tracks, rows, self._believed.wishes.copy(), self._believed.fastest)
        told = np.empty((len(rows), len(self._times), 2))
        self._roll_on(walkers, self._ground, self._manners, self._step, told)
        means, velocities = told, walkers.velocities
        if len(rows) < count:  # of the others nobody knows more than their tracks say
            means, velocities = np.full((count, len(self._times), 2), np.nan), tracks.velocities.copy()
            means[rows], velocities[rows] = told, walkers.velocities
        return Predictions.of(self._times, means, _spread(tracks.covariances, self._times), velocities)

    def _believe(self, tracks: Tracks, rows: NDArray[np.int64], stamp: float) -> None:
        """Take in what the tracks do now; a wish is what explains it."""
        velocities, ids = tracks.velocities[rows], tracks.ids[rows].tolist()
        lapse, self._stamp = max(stamp - self._stamp, 0.0), stamp
        speeds = np.hypot(velocities[:, 0], velocities[:, 1])
        now, known = Believed(ids, velocities.copy(), velocities.copy(), speeds), self._believed
        places = {number: row for row, number in enumerate(known.ids)}
        again = [(row, places[number]) for row, number in enumerate(ids) if number in places]
        if again:
            new, old = np.array(again).T
            now.wishes[new], now.before[new] = known.wishes[old], known.before[old]
            fading = np.exp(-lapse / self._rules.speed_time)
            now.fastest[new] = np.maximum(speeds[new], fading * known.fastest[old])
        if len(ids):
            self._infer_wishes(tracks, rows, now, lapse)
        self._believed = now

    def _infer_wishes(self, tracks: Tracks, rows: NDArray[np.int64], now: Believed, lapse: float) -> None:
        rules, velocities = self._rules, tracks.velocities[rows]
        walkers = self._walkers(tracks, rows, _with_length(now.wishes, now.fastest), now.fastest)
        slower = 1.0 + rules.doubt / rules.steady * np.sqrt(1.0 / walkers.trusted - 1.0)
        changes = (velocities - now.before) / (rules.acceleration_time * slower)[:, None]
        inferred = np.empty_like(now.wishes)
        self._infer(walkers, changes, self._ground, self._manners, inferred)
        lengths = np.hypot(inferred[:, 0], inferred[:, 1])
        inferred *= np.minimum(1.0, now.fastest / np.maximum(lengths, 1e-9))[:, None]
        taken, moved = (1.0 - np.exp(-lapse / (time * slower)) for time in (rules.wish_time, rules.acceleration_time))
        now.wishes += taken[:, None] * (inferred - now.wishes)
        now.before += moved[:, None] * (velocities - now.before)

    def _walkers(self, tracks: Tracks, rows: NDArray[np.int64], wishes: Floats, fastest: Floats) -> Walkers:
        places, velocities = np.array(tracks.positions[rows]), np.array(tracks.velocities[rows])
        unsure = 0.5 * (tracks.covariances[rows, 2, 2] + tracks.covariances[rows, 3, 3])
        trusted = 1.0 / (1.0 + unsure / np.maximum(self._rules.doubt * fastest, 1e-6) ** 2)
        return Walkers(places, velocities, np.array(tracks.radii[rows]), wishes, trusted, np.empty_like(places))


def ground_of(grid: OccupancyGrid) -> Ground:
    """Return a map as forces read it; meant for ``grid.derive(ground_of)``."""
    field = distance_field(grid.occupied, grid.resolution).astype(np.float32)
    pose = grid.origin
    return Ground(field, pose.x, pose.y, float(np.cos(pose.theta)), float(np.sin(pose.theta)), grid.resolution)


OPEN = Ground(np.full((2, 2), np.inf, np.float32), 0.0, 0.0, 1.0, 0.0, 1.0)


def _with_length(vectors: Floats, lengths: Floats) -> Floats:
    own = np.hypot(vectors[:, 0], vectors[:, 1])
    return vectors * (lengths / np.maximum(own, 1e-6))[:, None]


def _spread(covariances: Floats, times: Floats) -> Floats:
    """Return covariances (K, H, 2, 2) of tracks (K, 4, 4) that keep their velocities."""
    place, both, speed = covariances[:, None, :2, :2], covariances[:, None, :2, 2:], covariances[:, None, 2:, 2:]
    t = times[:, None, None]
    return np.asarray(place + t * (both + both.swapaxes(-1, -2)) + t**2 * speed)
