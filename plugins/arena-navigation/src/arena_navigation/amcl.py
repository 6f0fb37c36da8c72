"""Adaptive Monte Carlo localisation, modelled on ROS amcl and named as there."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    Bounds,
    ConfigurationError,
    Fraction,
    LaserScan,
    Localizer,
    NonNegative,
    OccupancyGrid,
    Pose,
    PoseEstimate,
    Positive,
    PositiveInt,
    Robot,
    Sensors,
    wrap_angle,
)
from arena_kernels.grids import stack_grids
from arena_navigation.amcl_beams import predicted, thinned
from arena_navigation.amcl_filter import Recovery, Resampling, begin, cloud
from arena_navigation.amcl_laser import BeamSkipping, LaserModel, LaserModelType
from arena_navigation.amcl_motion import Alphas, OdometryModelType, motion
from arena_navigation.amcl_ranges import Mixture
from arena_navigation.amcl_resampling import FreeSpace, Limits
from arena_navigation.amcl_sensor import Distances
from arena_navigation.odometry_history import OdometryHistory

NOWHERE = FreeSpace(np.zeros(1, np.int64), 1, 1.0)
RangeLimit = Annotated[float, Bounds(low=-1.0)]


class AmclLocalizer(Localizer):
    """A particle filter over poses on a known map, fed by odometry and scans."""

    needs_map: ClassVar[bool] = True

    def __init__(
        self,
        robot: Robot,
        min_particles: PositiveInt,
        max_particles: PositiveInt,
        kld_err: Positive,
        kld_z: NonNegative,
        update_min_d: NonNegative,
        update_min_a: NonNegative,
        resample_interval: PositiveInt,
        resample_independently: bool,
        estimate_after_resampling: bool,
        recovery_alpha_slow: Fraction,
        recovery_alpha_fast: Fraction,
        initial_cov_xx: NonNegative,
        initial_cov_yy: NonNegative,
        initial_cov_aa: NonNegative,
        laser_model_type: LaserModelType,
        laser_min_range: RangeLimit,
        laser_max_range: RangeLimit,
        laser_max_beams: PositiveInt,
        laser_z_hit: Fraction,
        laser_z_short: Fraction,
        laser_z_max: Fraction,
        laser_z_rand: Fraction,
        laser_sigma_hit: Positive,
        laser_lambda_short: Positive,
        laser_likelihood_max_dist: Positive,
        laser_to_surface: bool,
        laser_hollow: bool,
        laser_beam_weight: Fraction,
        short_beam_distance: Positive | None,
        do_beamskip: bool,
        beam_skip_distance: Positive,
        beam_skip_threshold: Fraction,
        beam_skip_error_threshold: Fraction,
        odom_model_type: OdometryModelType | None,
        odom_alpha1: NonNegative,
        odom_alpha2: NonNegative,
        odom_alpha3: NonNegative,
        odom_alpha4: NonNegative,
        odom_alpha5: NonNegative,
    ) -> None:
        if min_particles > max_particles:
            raise ConfigurationError(f"localizer amcl: min_particles is {min_particles}; allowed: at most max_particles {max_particles}")
        if do_beamskip and laser_model_type != "likelihood_field_prob":
            raise ConfigurationError(
                f"localizer.do_beamskip is true with {laser_model_type}; allowed: laser_model_type likelihood_field_prob"
            )
        self._limits = Limits(min_particles, max_particles, kld_err, kld_z, resample_independently)
        self._recovery = Recovery(recovery_alpha_slow, recovery_alpha_fast)
        self._least_motion = update_min_d, update_min_a
        self._resample_interval, self._estimate_after = resample_interval, estimate_after_resampling
        self._initial_covariance = np.diag((initial_cov_xx, initial_cov_yy, initial_cov_aa))
        self._range_limits = laser_min_range, laser_max_range
        self._max_beams = laser_max_beams
        skipping = BeamSkipping(beam_skip_distance, beam_skip_threshold, beam_skip_error_threshold)
        self._laser = LaserModel(
            laser_model_type,
            Mixture(laser_z_hit, laser_z_short, laser_z_max, laser_z_rand, laser_sigma_hit, laser_lambda_short),
            laser_likelihood_max_dist,
            Distances(laser_to_surface, laser_hollow),
            laser_beam_weight,
            skipping if do_beamskip else None,
        )
        self._short_by = short_beam_distance
        self._odometry_model = odom_model_type or ("omni-corrected" if robot.holonomic else "diff-corrected")
        self._alphas = Alphas(odom_alpha1, odom_alpha2, odom_alpha3, odom_alpha4, odom_alpha5)
        self._cloud = cloud(max_particles, laser_max_beams)

    def reset(self, grid: OccupancyGrid | None, start: Pose, random: np.random.Generator) -> None:
        """Draw particles about ``start``; raise ConfigurationError in an unknown world."""
        if grid is None:
            raise ConfigurationError("localizer amcl needs a known map; use localizer=ground_truth or world.known=true")
        self._grid = grid
        self._free = grid.derive(free_space) if self._recovery.alpha_slow > 0.0 else NOWHERE
        self._stack = stack_grids([grid])[0] if self._short_by is not None else None
        self._key = random.integers(0, 2**64, dtype=np.uint64)
        self._updates = 0
        self._history = OdometryHistory()
        self._filtered_at = -math.inf
        self._filtered_odometry: Pose | None = None
        self._estimated_odometry: Pose | None = None
        believed = grid.origin.relative(start)
        begin(self._cloud, believed.array(), _rotation(-grid.origin.theta) @ np.sqrt(self._initial_covariance), self._key)
        self._estimate, self._covariance = start, self._initial_covariance

    def update(self, sensors: Sensors) -> PoseEstimate:
        """Return the filter's latest pose, moved as odometry has moved since; use the scan if the robot has moved enough."""
        self._history.add(sensors.odometry)
        if self._filtered_odometry is None:
            self._filtered_odometry = self._estimated_odometry = self._history.at(sensors.stamp)
        if sensors.scan.stamp > self._filtered_at:
            self._consider(sensors.scan, self._history.at(sensors.scan.stamp))
        return PoseEstimate(self._carried_on(self._history.at(sensors.stamp)), self._covariance)

    @property
    def particles(self) -> NDArray[np.float64]:
        """Return the particles as rows of (x, y, theta) in ``map``, shape (N, 3)."""
        poses = self._cloud.poses[:, : self._cloud.number[0]].T @ _rotation(self._grid.origin.theta).T + self._grid.origin.array()
        poses[:, 2] = wrap_angle(poses[:, 2])
        return poses

    def _carried_on(self, odometry: Pose) -> Pose:
        """Return the latest estimate, moved to where odometry says ``odometry``."""
        assert self._estimated_odometry is not None
        return self._estimate.compose(self._estimated_odometry.relative(odometry))

    def _consider(self, scan: LaserScan, odometry: Pose) -> None:
        """Use a scan, seen when odometry said ``odometry``, if it is the first or the robot has moved enough since the last one."""
        assert self._filtered_odometry is not None
        displacement = self._filtered_odometry.relative(odometry)
        distance, angle = self._least_motion
        still = math.hypot(displacement.x, displacement.y) < distance and abs(displacement.theta) < angle
        if self._updates > 0 and still:
            return
        if self._filter(scan, displacement, self._carried_on(odometry)):
            self._estimated_odometry = odometry
        self._filtered_at, self._filtered_odometry = scan.stamp, odometry

    def _filter(self, scan: LaserScan, displacement: Pose, believed: Pose) -> bool:
        """Run one update of the filter, at ``believed`` so far, and take its estimate to ``map``; tell whether there is one."""
        max_range = scan.range_max if self._range_limits[1] < 0.0 else min(self._range_limits[1], scan.range_max)
        min_range = scan.range_min if self._range_limits[0] < 0.0 else self._range_limits[0]
        thin = thinned(scan, self._max_beams)
        least = self._least(thin, believed)
        self._updates += 1
        due = self._updates % self._resample_interval == 0
        moved = motion(displacement, self._odometry_model, self._alphas)
        resampling = Resampling(due, self._estimate_after, self._limits, self._free, self._recovery)
        self._laser.update(self._cloud, self._grid, moved, thin, (min_range, max_range), least, resampling, self._key, self._updates)
        if self._estimate_after and not due:
            return False
        self._estimate = self._grid.origin.compose(Pose.of(self._cloud.mean))
        self._covariance = _turned(self._cloud.covariance, self._grid.origin.theta)
        return True

    def _least(self, scan: LaserScan, pose: Pose) -> NDArray[np.float32] | float:
        """Return the range (B,), m, below which beams, seen from ``pose``, end well in front of the map.

        People shorten beams and never lengthen them (Fox, Burgard, Thrun, JAIR 11, 1999, call it a distance filter). The first scan is used
        whole, because only it tells where the robot really starts.
        """
        if self._stack is None or self._short_by is None or self._updates == 0:
            return 0.0
        least: NDArray[np.float32] = predicted(scan, self._stack, pose) - self._short_by
        return least


def free_space(grid: OccupancyGrid) -> FreeSpace:
    """Return the cells known to be free; all that are not occupied where none is known."""
    free = np.flatnonzero((grid.data >= 0) & ~grid.occupied)
    cells = free if len(free) else np.flatnonzero(~grid.occupied)
    return FreeSpace(cells.astype(np.int64), grid.data.shape[1], grid.resolution)


def _turned(covariance: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Return the covariance over (x, y, theta), given in axes that are turned by ``angle``, in the axes that are not."""
    rotation = _rotation(angle)
    turned: NDArray[np.float64] = rotation @ covariance @ rotation.T
    return turned


def _rotation(angle: float) -> NDArray[np.float64]:
    c, s = math.cos(angle), math.sin(angle)
    return np.array(((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)))
