"""The public core of the arena suite: values, interfaces and hook specifications for plugins and notebooks."""

from typing import Any

from arena_core.episode import (
    Contact,
    EpisodeRecord,
    EpisodeStart,
    Event,
    Outcome,
    Scenario,
    WorldState,
)
from arena_core.errors import (
    ArenaError,
    BrokenPlugin,
    ConfigurationError,
    ContractViolation,
    DuplicateComponent,
    ImpossibleScenario,
    InputFileError,
    InvalidCommand,
    NoPath,
    NoValidCommand,
    RunFolderError,
    UnknownComponent,
)
from arena_core.geometry import Footprint, Pose, Twist, wrap_angle
from arena_core.hookspecs import Register, hookimpl
from arena_core.interfaces import (
    OFF_PATH,
    WAYPOINT_FOUND,
    WAYPOINT_TIMEOUT,
    Command,
    Executor,
    GlobalPlanner,
    Job,
    LocalMap,
    Localizer,
    Metric,
    MetricPack,
    PathBatch,
    PedestrianModel,
    Planner,
    RobotBatch,
    Simulator,
    Snapshot,
    TaskMode,
    Tracker,
    WaypointGenerator,
    Waypoints,
    WorldSource,
)
from arena_core.parameters import Bounds, Fraction, NonNegative, NonNegativeInt, Positive, PositiveInt
from arena_core.robot import Lidar, OdometryModel, Robot, VelocityLimits, make_robot
from arena_core.sensing import NO_TRACKS, LaserScan, Observation, Odometry, PoseEstimate, Sensors, Tracks
from arena_core.streams import generator, stream_key
from arena_core.world import (
    FREE,
    INSCRIBED,
    LETHAL,
    OCCUPIED,
    UNKNOWN,
    Costmap,
    Crowd,
    Obstacle,
    OccupancyGrid,
    Path,
    Pedestrians,
    PedestrianSpec,
    World,
)

__version__ = "0.1.0"
