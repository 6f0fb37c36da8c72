"""``arena ros export``: the episodes of a run as a recording that RViz, Foxglove and PlotJuggler open."""

from __future__ import annotations

import itertools
import json
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from arena_core import (
    ArenaError,
    ConfigurationError,
    EpisodeRecord,
    InputFileError,
    LaserScan,
    OccupancyGrid,
    Pose,
    Twist,
)
from arena_core.records import read_grid, record_path, record_paths
from arena_ros import conversions as to
from arena_ros.codec import PEOPLE, Codec, Ros, get_codec

ENDINGS: dict[str, Ros] = {".bag": 1, ".mcap": 2, ".db3": 2}
BEGIN = 100 * 10**9  # ns, of the first episode: after 0, which ROS takes for "no time"
PAUSE = 5 * 10**9  # ns between two episodes
GOAL = {1: "/move_base_simple/goal", 2: "/goal_pose"}
LATCHED = frozenset({"/map", "/tf_static", "/arena/episode", "/plan", *GOAL.values()})
Write = Callable[[str, str, int, Any], None]  # topic, type, ns, message


def export_run(folder: Path, target: Path, episodes: Sequence[int] | None = None) -> int:
    """Write the records of a run to one file, episode after episode; return how many there were.

    Raises InputFileError and ConfigurationError in one line; a file that is there is not overwritten.
    """
    if target.suffix not in ENDINGS:
        raise ConfigurationError(f"out is {target.name}; allowed: a name that ends in {', '.join(ENDINGS)}")
    if target.exists():
        raise ConfigurationError(f"{target} is there already; allowed: a name that is free")
    numbers = _episode_numbers(folder) if episodes is None else list(episodes)
    own = get_codec(ENDINGS[target.suffix])
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=target.parent, prefix=f".{target.name}.") as beside:
            written = Path(beside) / target.name
            with open_writer(written, own) as write:
                begin = BEGIN
                for number in numbers:
                    begin = _write_episode(folder, number, own, write, begin) + PAUSE
            _finished_file(written).replace(target)
    except OSError as error:
        raise ArenaError(f"cannot write {target}: {error.strerror or error}") from None
    return len(numbers)


def _episode_numbers(folder: Path) -> list[int]:
    numbers = [int(path.stem) for path in record_paths(folder)]
    if not numbers:
        raise InputFileError(f"{folder}: has no records; allowed: a folder that `arena run` wrote")
    return numbers


def _finished_file(written: Path) -> Path:
    """Return the one file that a writer has left; one of ROS 2 makes a folder with its metadata."""
    return next(iter(sorted(written.glob(f"*{written.suffix}")))) if written.is_dir() else written


def open_writer(path: Path, own: Codec) -> AbstractContextManager[Write]:
    """Return what writes messages to a recording of a codec's generation, of the kind that its ending says."""
    return _Writer1(path, own) if own.ros == 1 else _Writer2(path, own)


class _Writer(AbstractContextManager[Write]):
    """Writes messages; channels are opened as they come."""

    def __init__(self, path: Path, own: Codec) -> None:
        self.own = own
        self._channels: dict[str, Any] = {}
        self._stack = ExitStack()
        self._writer = self._stack.enter_context(self._open_bag(path))

    def _open_bag(self, path: Path) -> Any:
        raise NotImplementedError

    def _open_channel(self, topic: str, name: str) -> Any:
        raise NotImplementedError

    def __enter__(self) -> Write:
        return self._write_message

    def __exit__(self, *raised: Any) -> None:
        self._stack.close()

    def _write_message(self, topic: str, name: str, stamp: int, message: Any) -> None:
        if topic not in self._channels:
            self._channels[topic] = self._open_channel(topic, name)
        self._writer.write(self._channels[topic], stamp, self.own.encode(message, name))


class _Writer1(_Writer):
    def _open_bag(self, path: Path) -> Any:
        from rosbags.rosbag1 import Writer

        writer = Writer(path)
        writer.set_compression(Writer.CompressionFormat.LZ4)
        return writer

    def _open_channel(self, topic: str, name: str) -> Any:
        return self._writer.add_connection(topic, name, typestore=self.own.store, latching=int(topic in LATCHED))


class _Writer2(_Writer):
    def _open_bag(self, path: Path) -> Any:
        from rosbags.rosbag2 import StoragePlugin, Writer

        plugin = StoragePlugin.MCAP if path.suffix == ".mcap" else StoragePlugin.SQLITE3
        return Writer(path, version=9, storage_plugin=plugin)

    def _open_channel(self, topic: str, name: str) -> Any:
        from rosbags.interfaces import (
            Qos,
            QosDurability,
            QosHistory,
            QosLiveliness,
            QosReliability,
            QosTime,
        )

        none, kept = QosTime(0, 0), topic in LATCHED
        durability = QosDurability.TRANSIENT_LOCAL if kept else QosDurability.VOLATILE
        profile = Qos(
            QosHistory.KEEP_LAST,
            1 if kept else 10,
            QosReliability.RELIABLE,
            durability,
            none,
            none,
            QosLiveliness.AUTOMATIC,
            none,
            False,
        )
        return self._writer.add_connection(topic, name, typestore=self.own.store, offered_qos_profiles=[profile])


def _write_episode(folder: Path, number: int, own: Codec, write: Write, begin: int) -> int:
    """Write an episode from ``begin`` ns on; return when it ends."""
    from arena_core.records import read_record

    record = read_record(record_path(folder, number))
    stamps = begin + np.rint((record["stamp"] - record["stamp"][0]) * 1e9).astype(np.int64)
    _write_begin(folder, record, own, write, begin)
    paths = _path_messages(record, own, begin)
    upcoming = next(paths, None)
    for row, stamp in enumerate(stamps.tolist()):
        while upcoming is not None and upcoming[0] <= stamp:
            write("/plan", to.PATH, *upcoming)
            upcoming = next(paths, None)
        for topic, name, message in _row_messages(record, row, own, stamp):
            write(topic, name, stamp, message)
    end = {
        "event": "end",
        "outcome": record.meta["outcome"],
        "error": record.meta["error"],
        "events": record.meta["events"],
    }
    end["path_stamps"] = record["path_stamps"].tolist()
    end["contacts"] = {name: record[name].tolist() for name in _CONTACTS}
    write("/arena/episode", to.TEXT, int(stamps[-1]), to.text_msg(own, json.dumps(end)))
    return int(stamps[-1])


_CONTACTS = ("contact_stamp", "contact_kind", "contact_person", "contact_speed", "contact_caused", "contact_position")


def _write_begin(folder: Path, record: EpisodeRecord, own: Codec, write: Write, begin: int) -> None:
    people = {
        "ids": record["pedestrian_ids"].tolist(),
        "radii": record["pedestrian_radii"].tolist(),
        **_person_routes(record),
    }
    meta = {key: value for key, value in record.meta.items() if key not in ("outcome", "error", "events")}
    write(
        "/arena/episode",
        to.TEXT,
        begin,
        to.text_msg(own, json.dumps({"event": "begin", "meta": meta, "people": people})),
    )
    if (grid := _read_grid(folder, record)) is not None:
        write("/map", to.GRID, begin, to.grid_msg(own, grid, begin, "map"))
    write(
        GOAL[own.ros],
        to.POSE_STAMPED,
        begin,
        to.pose_stamped_msg(own, Pose.of(record.meta["scenario"]["goal"]), begin, "map"),
    )
    write("/tf_static", to.TF, begin, to.transforms_msg(own, [("base_link", "laser", _lidar_mount(record))], begin))


def _person_routes(record: EpisodeRecord) -> dict[str, Any]:
    """Return where everybody was to go; records from before routes were kept do not say."""
    if "route_offsets" not in record.arrays:
        return {}
    points, offsets = record["route_points"], record["route_offsets"].tolist()
    return {"routes": [points[first:last].tolist() for first, last in itertools.pairwise(offsets)]}


def _read_grid(folder: Path, record: EpisodeRecord) -> OccupancyGrid | None:
    name = record.meta["world"].get("grid")
    if name is None or not (folder / name).is_file():
        return None
    return read_grid(folder / name)


def _lidar_settings(record: EpisodeRecord) -> dict[str, Any]:
    """Return the figures of the robot's lidar; a record made elsewhere may have none."""
    return (record.meta["config"].get("robot") or {}).get("lidar") or {}


def _lidar_mount(record: EpisodeRecord) -> Pose:
    mount = _lidar_settings(record).get("mount") or {}
    return Pose(mount.get("x", 0.0), mount.get("y", 0.0), mount.get("theta", 0.0))


def _path_messages(record: EpisodeRecord, own: Codec, begin: int) -> Iterator[tuple[int, Any]]:
    offsets = record["path_offsets"]
    for k, stamp in enumerate(record["path_stamps"].tolist()):
        when = begin + round((stamp - record["stamp"][0]) * 1e9)
        yield when, to.path_msg(own, record["path_poses"][offsets[k] : offsets[k + 1]], when, "map")


def _row_messages(record: EpisodeRecord, row: int, own: Codec, stamp: int) -> Iterator[tuple[str, str, Any]]:
    truth, twist = Pose.of(record["pose"][row]), Twist.of(record["twist"][row])
    start = Pose.of(record["pose"][0])
    driven, estimate = start.relative(truth), record["estimate"][row]
    known = bool(np.isfinite(estimate).all())
    believed = Pose.of(estimate) if known else truth
    # map -> odom, so that map -> base_link is what was believed
    to_odom = believed.compose(driven.relative(Pose(0.0, 0.0)))
    yield "/tf", to.TF, to.transforms_msg(own, [("map", "odom", to_odom), ("odom", "base_link", driven)], stamp)
    yield "/odom", to.ODOMETRY, to.odometry_msg(own, driven, twist, to.Header(stamp, "odom"), "base_link")
    yield "/ground_truth", to.ODOMETRY, to.odometry_msg(own, truth, twist, to.Header(stamp, "map"), "base_link")
    if known:
        covariance = record["estimate_covariance"][row]
        yield "/amcl_pose", to.POSE_COVARIANCE, to.pose_covariance_msg(own, believed, covariance, stamp, "map")
    if "scan_ranges" in record.arrays and row < len(record["scan_ranges"]) and (lidar := _lidar_settings(record)):
        first, step, nearest, farthest = (
            float(lidar[key]) for key in ("angle_min", "angle_increment", "range_min", "range_max")
        )
        scan = LaserScan(0.0, first, step, nearest, farthest, record["scan_ranges"][row], _lidar_mount(record))
        yield "/scan", to.SCAN, to.scan_msg(own, scan, stamp, "laser", float(lidar["period"]))
    if len(record["pedestrian_ids"]):
        positions, ids = record["pedestrian_positions"][row].astype(float), record["pedestrian_ids"].tolist()
        velocities = record["pedestrian_velocities"][row].astype(float)
        yield "/people", PEOPLE, to.people_msg(own, ids, positions, velocities, to.Header(stamp, "map"))
        yield (
            "/people_markers",
            to.MARKERS,
            to.markers_msg(own, ids, positions, record["pedestrian_radii"], to.Header(stamp, "map")),
        )
    if np.isfinite(record["waypoint"][row]).all():
        yield "/waypoint", to.POSE_STAMPED, to.pose_stamped_msg(own, Pose.of(record["waypoint"][row]), stamp, "map")
    state = [float(record[name][row]) for name in _STATE] + record["pedestrian_states"][row].astype(float).tolist()
    yield "/arena/state", to.NUMBERS, to.numbers_msg(own, state)
    if np.isfinite(record["command"][row]).all():
        yield "/cmd_vel", to.TWIST, to.twist_msg(own, Twist.of(record["command"][row]))


_STATE = ("stamp", "clearance", "clearance_people", "in_contact", "contact_time", "scan_min")
