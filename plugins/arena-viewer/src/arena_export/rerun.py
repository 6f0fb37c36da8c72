"""Episodes as recordings of Rerun, in 3-D: ``arena-viewer[rerun]``."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from arena_core import ArenaError, EpisodeRecord
from arena_core.hosting import require_extra
from arena_core.records import Export, read_grid, read_record, record_path
from arena_export.socnav import facings, trajectory_name
from arena_export.walls import wall_segments

if TYPE_CHECKING:
    import rerun

Floats = NDArray[np.float64]

CLOCK = "time"  # the timeline, s from the episode's begin
WALL, ROBOT, PERSON = 1.0, 0.3, 1.7  # [m] heights that are drawn: the records are flat
GREY, BLUE, ORANGE, GREEN, RED = (150, 150, 155), (42, 111, 178), (230, 140, 50), (60, 160, 90), (200, 50, 50)
LINE, POINT = 0.02, 0.03  # [m] radii


class RerunExport(Export):
    """One .rrd file an episode; Rerun opens several as recordings beside each other."""

    help: ClassVar[str] = "recordings of Rerun in 3-D, one file an episode: rerun FOLDER/*.rrd"
    ending: ClassVar[str] = ""

    def write(self, folder: Path, target: Path, episodes: Sequence[int]) -> None:
        """Write a folder of files ``NNNN.rrd``, whole or not at all."""
        require_extra("arena export to=rerun", ("rerun",), "arena-viewer[rerun]")
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=target.parent, prefix=f".{target.name}.") as beside:
                whole = Path(beside) / "all"
                whole.mkdir()
                for number in episodes:
                    record = read_record(record_path(folder, number))
                    write_recording(whole / f"{number:04d}.rrd", record, _walls(folder, record))
                whole.rename(target)
        except OSError as error:
            raise ArenaError(f"cannot write {target}: {error.strerror or error}") from None


def write_recording(path: Path, record: EpisodeRecord, walls: Floats) -> None:
    """Write an episode with the map's walls (K, 4) m as one recording."""
    import rerun as rr

    stream = rr.RecordingStream("arena", recording_id=trajectory_name(record))
    stream.save(path)
    stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    if len(walls):
        corners, triangles = wall_mesh(walls)
        mesh = rr.Mesh3D(vertex_positions=corners, triangle_indices=triangles, vertex_colors=[GREY] * len(corners))
        stream.log("world/walls", mesh, static=True)
    x, y, _ = record.meta["scenario"]["goal"]
    radius = float(record.meta["scenario"]["goal_radius"])
    goal = rr.Cylinders3D(lengths=[0.02], radii=[radius], centers=[(x, y, 0.01)], colors=[GREEN])
    stream.log("world/goal", goal, static=True)
    _log_robot(stream, record)
    _log_people(stream, record)
    _log_paths(stream, record)
    _log_figures(stream, record)
    stream.flush()
    stream.disconnect()


def wall_mesh(walls: Floats) -> tuple[Floats, NDArray[np.uint32]]:
    """Return corners (4 K, 3) m and triangles (2 K, 3) of upright rectangles on line segments (K, 4) m."""
    low = np.concatenate([walls.reshape(-1, 2, 2), np.zeros((len(walls), 2, 1))], axis=2)
    corners = np.concatenate([low, low + np.array((0.0, 0.0, WALL))], axis=1).reshape(-1, 3)
    first = 4 * np.arange(len(walls), dtype=np.uint32)[:, None]
    triangles = np.concatenate([first + np.array([0, 1, 2]), first + np.array([1, 3, 2])])
    return corners, triangles.astype(np.uint32)


def _walls(folder: Path, record: EpisodeRecord) -> Floats:
    name = record.meta["world"].get("grid")
    return wall_segments(read_grid(folder / name)) if name else np.empty((0, 4))


def _times(stamps: Floats) -> list[Any]:
    import rerun as rr

    return [rr.TimeColumn(CLOCK, duration=np.asarray(stamps, np.float64))]


def _turns(angles: Floats) -> Floats:
    """Return quaternions (T, 4) x, y, z, w about the vertical."""
    half = np.asarray(angles, np.float64) / 2.0
    nothing = np.zeros_like(half)
    return np.stack([nothing, nothing, np.sin(half), np.cos(half)], axis=-1)


def _upright(places: Floats, height: float) -> Floats:
    return np.column_stack([places, np.full(len(places), height)])


def _log_robot(stream: rerun.RecordingStream, record: EpisodeRecord) -> None:
    import rerun as rr

    footprint, pose = record.meta["robot"]["footprint"], record["pose"]
    if len(footprint["vertices_xy"]):
        points = np.array(footprint["vertices_xy"])
        low, high = points.min(axis=0), points.max(axis=0)
        half, middle = (*((high - low) / 2.0), ROBOT / 2.0), (*((low + high) / 2.0), ROBOT / 2.0)
        body: Any = rr.Boxes3D(half_sizes=[half], centers=[middle], colors=[BLUE], fill_mode="solid")
    else:
        radius = float(footprint["radius"])
        body = rr.Cylinders3D(lengths=[ROBOT], radii=[radius], centers=[(0, 0, ROBOT / 2.0)], colors=[BLUE])
    stream.log("world/robot", body, static=True)
    ahead = rr.Arrows3D(vectors=[(0.4, 0.0, 0.0)], origins=[(0.0, 0.0, ROBOT)], colors=[BLUE], radii=[LINE])
    stream.log("world/robot/ahead", ahead, static=True)
    moves = rr.Transform3D.columns(translation=_upright(pose[:, :2], 0.0), quaternion=_turns(pose[:, 2]))
    stream.send_columns("world/robot", _times(record["stamp"]), moves)
    trail = rr.LineStrips3D([_upright(pose[:, :2], LINE)], radii=[LINE], colors=[BLUE])
    stream.log("world/trail", trail, static=True)


def _log_people(stream: rerun.RecordingStream, record: EpisodeRecord) -> None:
    """Log people as capsules that face the way they walk; who is not there in a row is left out of it."""
    import rerun as rr

    places = np.asarray(record["pedestrian_positions"], np.float64)
    if not places.shape[1]:
        return
    there = np.isfinite(places[..., 0])
    radii = np.broadcast_to(record["pedestrian_radii"], there.shape)[there]
    names = np.broadcast_to([f"person {number}" for number in record["pedestrian_ids"].tolist()], there.shape)[there]
    bodies = rr.Capsules3D.columns(
        lengths=np.maximum(PERSON - 2.0 * radii, 0.0),
        radii=radii,
        translations=np.column_stack([places[there], radii]),
        colors=np.tile(np.array(ORANGE, np.uint8), (len(radii), 1)),
        labels=names.tolist(),
    )
    counts = there.sum(axis=1)
    stream.send_columns("world/people", _times(record["stamp"]), bodies.partition(counts))
    facing = facings(np.asarray(record["pedestrian_velocities"], np.float64))[there]
    looks = rr.Arrows3D.columns(
        vectors=0.5 * np.stack([np.cos(facing), np.sin(facing), np.zeros_like(facing)], axis=1),
        origins=_upright(places[there], PERSON),
    )
    stream.send_columns("world/people/ahead", _times(record["stamp"]), looks.partition(counts))


def _log_paths(stream: rerun.RecordingStream, record: EpisodeRecord) -> None:
    """Log the global paths, each from when it was planned, and the beams' ends where scans were recorded."""
    import rerun as rr

    offsets = record["path_offsets"].tolist()
    for stamp, first, last in zip(record["path_stamps"].tolist(), offsets, offsets[1:], strict=False):
        stream.set_time(CLOCK, duration=stamp)
        path = rr.LineStrips3D([_upright(record["path_poses"][first:last, :2], LINE)], radii=[LINE], colors=[GREEN])
        stream.log("world/path", path)
    stream.reset_time()
    if "scan_ranges" in record.arrays:
        _log_scans(stream, record)


def _log_scans(stream: rerun.RecordingStream, record: EpisodeRecord) -> None:
    import rerun as rr

    lidar = record.meta["config"]["robot"]["lidar"]
    ranges = np.asarray(record["scan_ranges"], np.float64)
    mount = lidar.get("mount") or {}
    angles = lidar["angle_min"] + lidar["angle_increment"] * np.arange(ranges.shape[1]) + mount.get("theta", 0.0)
    hit = np.isfinite(ranges) & (ranges < lidar["range_max"])
    ends = np.stack([ranges * np.cos(angles) + mount.get("x", 0.0), ranges * np.sin(angles) + mount.get("y", 0.0)], -1)
    points = rr.Points3D.columns(positions=_upright(ends[hit], ROBOT / 2.0))
    stream.send_columns("world/robot/scan", _times(record["stamp"][: len(ranges)]), points.partition(hit.sum(axis=1)))


def _log_figures(stream: rerun.RecordingStream, record: EpisodeRecord) -> None:
    """Log speed and clearance as curves, events as text, contacts as points."""
    import rerun as rr

    stamps = record["stamp"]
    speeds = np.hypot(*record["twist"][:, :2].T)
    for name, figures in (("speed", speeds), ("clearance", record["clearance"])):
        known = np.isfinite(figures)
        stream.send_columns(f"figures/{name}", _times(stamps[known]), rr.Scalars.columns(scalars=figures[known]))
    events = [(event["stamp"], f"{event['kind']} {event['detail']}".strip()) for event in record.meta["events"]]
    if events:
        texts = rr.TextLog.columns(text=[text for _, text in events])
        stream.send_columns("events", _times(np.array([stamp for stamp, _ in events])), texts)
    if len(contacts := record["contact_stamp"]):
        places = _upright(np.asarray(record["contact_position"], np.float64).reshape(-1, 2), ROBOT)
        marks = rr.Points3D.columns(
            positions=places, radii=np.full(len(places), 3 * POINT), colors=np.tile(RED, (len(places), 1))
        )
        stream.send_columns("world/contacts", _times(contacts), marks)
