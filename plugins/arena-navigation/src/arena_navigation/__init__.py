"""A*, waypoint generators, local costmap and localisers for the arena suite."""

from arena_core import Register, hookimpl


@hookimpl
def register_global_planners(register: Register) -> None:
    """Offer A* on the inflated map."""
    register("astar", "arena_navigation.planning.astar:AstarPlanner")


@hookimpl
def register_waypoint_generators(register: Register) -> None:
    """Offer the spatial horizon and waypoints at even spacing."""
    register("spatial_horizon", "arena_navigation.planning.waypoints:SpatialHorizon")
    register("subsample", "arena_navigation.planning.waypoints:Subsample")


@hookimpl
def register_local_maps(register: Register) -> None:
    """Offer the rolling costmap."""
    register("rolling", "arena_navigation.local_map.rolling:RollingMap")


@hookimpl
def register_trackers(register: Register) -> None:
    """Offer Kalman filters over discs, the true people, and the tracker that sees nothing move."""
    register("none", "arena_navigation.tracking.no_tracker:NoTracker")
    register("kalman", "arena_navigation.tracking.tracker:KalmanTracker")
    register("ground_truth", "arena_navigation.tracking.true_tracks:GroundTruthTracker")


@hookimpl
def register_predictors(register: Register) -> None:
    """Offer who goes on as they go, and what people will truly do."""
    register("constant_velocity", "arena_navigation.prediction.constant_velocity:ConstantVelocity")
    register("truth", "arena_navigation.prediction.true_future:TrueFuture")


@hookimpl
def register_communications(register: Register) -> None:
    """Offer robots that tell each other where they are."""
    register("broadcast", "arena_navigation.communication.broadcast:Broadcast")


@hookimpl
def register_localizers(register: Register) -> None:
    """Offer adaptive Monte Carlo localisation, a model of its error, dead reckoning and the exact pose."""
    register("ground_truth", "arena_navigation.localizers:GroundTruthLocalizer")
    register("amcl", "arena_navigation.amcl.localizer:AmclLocalizer")
    register("gauss_markov", "arena_navigation.gauss_markov:GaussMarkovLocalizer")
    register("odometry", "arena_navigation.localizers:OdometryLocalizer")


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_navigation.conf"
