"""Adaptive Monte Carlo localisation, modelled on ROS amcl and named as there."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ConfigurationError,
    LaserScan,
    Localizer,
    OccupancyGrid,
    Pose,
    PoseEstimate,
    Robot,
    Sensors,
    wrap_angle,
)
from arena_kernels.grids import stack_grids
from arena_navigation.amcl.beams import NO_WALLS, ExpectedWalls, thin_scan
from arena_navigation.amcl.draws import Draw
from arena_navigation.amcl.filter import Recovery, Resampling, Update, draw_particles, make_cloud
from arena_navigation.amcl.laser import BeamSkipping, LaserModel, ScanView
from arena_navigation.amcl.motion import Alphas, odometry_motion
from arena_navigation.amcl.odometry_history import OdometryHistory
from arena_navigation.amcl.parameters import (
    BeamSkipParameters,
    InitialParameters,
    LaserParameters,
    OdomParameters,
    ParticleParameters,
    RecoveryParameters,
    ResampleParameters,
    UpdateParameters,
)
from arena_navigation.amcl.ranges import Mixture
from arena_navigation.amcl.resampling import FreeSpace, ParticleLimits
from arena_navigation.amcl.sensor import Distances
from arena_navigation.columns import THETA

NOWHERE = FreeSpace(np.zeros(1, np.int64), 1, 1.0)


class AmclLocalizer(Localizer):
    """A particle filter over poses on a known map, fed by odometry and scans."""

    needs_map: ClassVar[bool] = True

    def __init__(
        self,
        robot: Robot,
        particles: ParticleParameters,
        update: UpdateParameters,
        resample: ResampleParameters,
        recovery: RecoveryParameters,
        initial: InitialParameters,
        laser: LaserParameters,
        beam_skip: BeamSkipParameters,
        odom: OdomParameters,
    ) -> None:
        self._limits = ParticleLimits(
            particles.min, particles.max, particles.kld_err, particles.kld_z, resample.independently
        )
        self._recovery = Recovery(recovery.alpha_slow, recovery.alpha_fast)
        self._update = update
        self._resample = resample
        self._initial_covariance = np.diag((initial.cov_xx, initial.cov_yy, initial.cov_aa))
        self._parameters = laser
        self._laser = laser_model(laser, beam_skip)
        self._odometry_model = odom.model_type or ("omni-corrected" if robot.holonomic else "diff-corrected")
        self._alphas = Alphas(odom.alpha1, odom.alpha2, odom.alpha3, odom.alpha4, odom.alpha5)
        self._cloud = make_cloud(particles.max, laser.max_beams)

    def reset(self, grid: OccupancyGrid | None, start: Pose, random: np.random.Generator) -> None:
        """Draw particles about ``start``; raise ConfigurationError in an unknown world."""
        if grid is None:
            raise ConfigurationError("localizer amcl needs a known map; use localizer=ground_truth or world.known=true")
        self._grid = grid
        self._free = grid.derive(free_space) if self._recovery.alpha_slow > 0.0 else NOWHERE
        self._stack = stack_grids([grid])[0] if self._parameters.short_beam_distance is not None else None
        self._key = random.integers(0, 2**64, dtype=np.uint64)
        self._updates = 0
        self._history = OdometryHistory()
        self._filtered_at = -math.inf
        self._filtered_odometry: Pose | None = None
        self._estimated_odometry: Pose | None = None
        believed = grid.origin.relative(start)
        draw_particles(
            self._cloud,
            believed.array(),
            _rotation_matrix(-grid.origin.theta) @ np.sqrt(self._initial_covariance),
            self._key,
        )
        self._estimate, self._covariance = start, self._initial_covariance

    def update(self, sensors: Sensors) -> PoseEstimate:
        """Return the filter's latest pose, moved as odometry has moved since; use the
        scan if the robot has moved enough.
        """
        self._history.add(sensors.odometry)
        if self._filtered_odometry is None:
            self._filtered_odometry = self._estimated_odometry = self._history.at(sensors.stamp)
        if sensors.scan.stamp > self._filtered_at:
            self._consider_scan(sensors.scan, self._history.at(sensors.scan.stamp))
        return PoseEstimate(self._extrapolated_estimate(self._history.at(sensors.stamp)), self._covariance)

    @property
    def particles(self) -> NDArray[np.float64]:
        """Return the particles as rows of (x, y, theta) in ``map``, shape (N, 3)."""
        poses = (
            self._cloud.poses[:, : self._cloud.number[0]].T @ _rotation_matrix(self._grid.origin.theta).T
            + self._grid.origin.array()
        )
        poses[:, THETA] = wrap_angle(poses[:, THETA])
        return poses

    def _extrapolated_estimate(self, odometry: Pose) -> Pose:
        """Return the latest estimate, moved to where odometry says ``odometry``."""
        assert self._estimated_odometry is not None
        return self._estimate.compose(self._estimated_odometry.relative(odometry))

    def _consider_scan(self, scan: LaserScan, odometry: Pose) -> None:
        """Use a scan, seen when odometry said ``odometry``, if it is the first or the robot has
        moved enough since the last one.
        """
        assert self._filtered_odometry is not None
        displacement = self._filtered_odometry.relative(odometry)
        still = (
            math.hypot(displacement.x, displacement.y) < self._update.min_d
            and abs(displacement.theta) < self._update.min_a
        )
        if self._updates > 0 and still:
            return
        if self._run_filter(scan, displacement, self._extrapolated_estimate(odometry)):
            self._estimated_odometry = odometry
        self._filtered_at, self._filtered_odometry = scan.stamp, odometry

    def _run_filter(self, scan: LaserScan, displacement: Pose, believed: Pose) -> bool:
        """Run one update of the filter, at ``believed`` so far, and take its estimate to ``map``;
        return whether there is one.
        """
        laser, resample = self._parameters, self._resample
        max_range = float(scan.range_max if laser.max_range < 0.0 else min(laser.max_range, scan.range_max))
        min_range = float(scan.range_min if laser.min_range < 0.0 else laser.min_range)
        thin = thin_scan(scan, laser.max_beams)
        walls = self._expected_walls(scan, believed)
        self._updates += 1
        due = self._updates % resample.interval == 0
        moved = odometry_motion(displacement, self._odometry_model, self._alphas)
        resampling = Resampling(due, resample.estimate_after, self._limits, self._free, self._recovery)
        update = Update(moved, resampling, Draw(self._key, self._updates))
        self._laser.update(self._cloud, self._grid, update, ScanView(thin, (min_range, max_range), walls))
        if resample.estimate_after and not due:
            return False
        self._estimate = self._grid.origin.compose(Pose.of(self._cloud.mean))
        self._covariance = _rotate_covariance(self._cloud.covariance, self._grid.origin.theta)
        return True

    def _expected_walls(self, scan: LaserScan, believed: Pose) -> ExpectedWalls:
        """Return what the scan's beams are expected to hit, ``base_link`` at ``believed`` in ``map``.

        People shorten beams and never lengthen them (Fox, Burgard, Thrun, JAIR 11, 1999, call it a distance filter).
        The first scan is used whole, because only it tells where the robot really starts.
        """
        short_by = self._parameters.short_beam_distance
        if self._stack is None or short_by is None or self._updates == 0:
            return NO_WALLS
        sensor = believed.compose(scan.mount)
        return ExpectedWalls(self._stack, (sensor.x, sensor.y, sensor.theta), short_by)


def laser_model(laser: LaserParameters, beam_skip: BeamSkipParameters) -> LaserModel:
    """Return the sensor model; raise ConfigurationError where it cannot skip beams."""
    if beam_skip.enabled and laser.model_type != "likelihood_field_prob":
        allowed = "laser.model_type likelihood_field_prob"
        raise ConfigurationError(f"localizer.beam_skip.enabled is true with {laser.model_type}; allowed: {allowed}")
    skipping = BeamSkipping(beam_skip.distance, beam_skip.threshold, beam_skip.error_threshold)
    return LaserModel(
        laser.model_type,
        Mixture(laser.z_hit, laser.z_short, laser.z_max, laser.z_rand, laser.sigma_hit, laser.lambda_short),
        laser.likelihood_max_dist,
        Distances(laser.to_surface, laser.hollow),
        laser.beam_weight,
        skipping if beam_skip.enabled else None,
    )


def free_space(grid: OccupancyGrid) -> FreeSpace:
    """Return the cells known to be free; all that are not occupied where none is known."""
    free = np.flatnonzero((grid.data >= 0) & ~grid.occupied)
    cells = free if len(free) else np.flatnonzero(~grid.occupied)
    return FreeSpace(cells.astype(np.int64), grid.data.shape[1], grid.resolution)


def _rotate_covariance(covariance: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Return the covariance over (x, y, theta), given in axes that are turned by
    ``angle``, in the axes that are not.
    """
    rotation = _rotation_matrix(angle)
    turned: NDArray[np.float64] = rotation @ covariance @ rotation.T
    return turned


def _rotation_matrix(angle: float) -> NDArray[np.float64]:
    c, s = math.cos(angle), math.sin(angle)
    return np.array(((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)))
