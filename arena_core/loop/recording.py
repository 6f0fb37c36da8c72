"""Records of episodes: collect them, write them whole, read them back (docs/records.md lists every array)."""

from __future__ import annotations

import io
import json
import os
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from hashlib import blake2b
from pathlib import Path
from secrets import token_hex
from typing import IO, Any
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np
from numpy.typing import NDArray

from arena_core.base.arrays import read_arrays
from arena_core.base.errors import InputFileError, RunFolderError, one_line
from arena_core.base.files import AnyPath, reason_of
from arena_core.base.frozen import frozen
from arena_core.base.limits import LIMITS
from arena_core.base.stopwatch import Duration
from arena_core.loop.extras import candidate_arrays, track_arrays
from arena_core.loop.navigator import Decision, Spent
from arena_core.loop.record_layout import fault_of, fault_of_timing
from arena_core.loop.record_places import NUMBERED, PARTS, record_path, run_folder_of, timing_of, timing_path
from arena_core.values.candidate import Candidate
from arena_core.values.episode import Contact, EpisodeRecord, Event, Outcome, Scenario, WorldState
from arena_core.values.furniture import furniture_meta
from arena_core.values.geometry import Pose
from arena_core.values.robot import Robot
from arena_core.values.sensing import Sensors
from arena_core.values.world import OccupancyGrid, PedestrianSpec
from arena_core.values.world import Path as GlobalPath

FORMAT = 1
GRAIN = {  # binary places that are kept, finer than what any simulator or sensor means by its digits; the rest is noise that does not pack
    "pose": 22,
    "twist": 22,
    "estimate": 20,
    "waypoint": 16,
    "path_poses": 16,
    "clearance": 16,
    "clearance_people": 16,
    "scan_min": 16,
    "pedestrian_positions": 12,
    "pedestrian_velocities": 11,
}
TIME_GRAIN = 20  # binary places of everything in timing/, s
CONTACT_KINDS = ("wall", "obstacle", "person")
HALF_WRITTEN = re.compile(r"\..+\.[0-9a-f]{8}")  # the names that write_whole gives
ROOM = ".room.00000000"  # goes wherever half-written files go


class Recorder:
    """Collects one episode step by step: what is true and measured, then what was decided; ``meta`` identifies it, plain JSON."""

    def __init__(
        self,
        scenario: Scenario,
        robot: Robot,
        meta: Mapping[str, Any],
        keep_scans: bool,
        keep_tracks: bool = False,
        keep_considered: bool = False,
    ) -> None:
        self._people = scenario.pedestrians
        self._meta = {"format": FORMAT, **meta, "scenario": _scenario_meta(scenario), "robot": robot_meta(robot)}
        self._keep_scans, self._keep_tracks, self.keeps_considered = keep_scans, keep_tracks, keep_considered
        self._states: list[WorldState] = []
        self._decisions: list[Decision] = []
        self._scan_minima: list[float] = []
        self._scans: list[NDArray[np.float32]] = []
        self._considered: list[list[Candidate]] = []

    def sense(self, state: WorldState, sensors: Sensors) -> None:
        """Take in what is true and what was measured at a control step, before anybody decides; it counts once a decision is added."""
        self._sensed = state, float(sensors.scan.ranges.min()), frozen(sensors.scan.ranges) if self._keep_scans else None

    def add(self, decision: Decision, considered: list[Candidate] | None = None) -> None:
        """Take in what was decided on what was sensed last, and what is kept of what the planner considered."""
        state, scan_minimum, scan = self._sensed
        self._states.append(state)
        self._decisions.append(decision)
        self._scan_minima.append(scan_minimum)
        if scan is not None:
            self._scans.append(scan)
        if self.keeps_considered:
            self._considered.append(considered or [])

    def finish(self, state: WorldState, outcome: Outcome, error: str, decision: Decision | None = None) -> EpisodeRecord:
        """Close the record with the final state (and the decision that ended it, if one did)."""
        states = [*self._states, state]
        arrays = {
            **_truth_arrays(states),
            **_decision_arrays(self._decisions, decision),
            **_people_arrays(states),
            **_route_arrays(states[0].pedestrians.ids, self._people),
            **_contact_arrays([c for s in states for c in s.contacts]),
            **_path_arrays(self._decisions),
            "scan_min": np.array([*self._scan_minima, np.nan]),
        }
        if self._keep_scans:
            arrays["scan_ranges"] = np.array(self._scans, dtype=np.float32)
        if self._keep_tracks:
            arrays |= track_arrays([d.tracks for d in self._decisions])
        if self.keeps_considered:
            arrays |= candidate_arrays(self._considered)
        events = [_event(e) for d in self._decisions for e in d.events]
        meta = {**self._meta, "outcome": outcome, "error": error, "events": events}
        return EpisodeRecord(rounded(arrays), meta, _timing_arrays(self._decisions))


def write_record(folder: Path, episode: int, record: EpisodeRecord) -> None:
    """Write ``records/NNNN.npz`` and ``timing/NNNN.npz`` (record_places.py), each whole or not at all."""
    meta = json.dumps(record.meta, sort_keys=True)
    timing, arrays = timing_path(folder, episode), record_path(folder, episode)
    check_inside(folder, timing.parent)
    check_inside(folder, arrays.parent)
    write_whole(timing, lambda file: _write_npz(file, record.timing))
    write_whole(arrays, lambda file: _write_npz(file, {"meta": np.array(meta), **record.arrays}))


def read_record(path: AnyPath) -> EpisodeRecord:
    """Read a record with its timing; raise InputFileError when it is missing, damaged, of another format, or a link out of the run."""
    path = Path(path)
    check_inside(run_folder_of(path), path)
    arrays = _read_npz(path)
    try:
        meta = json.loads(str(arrays.pop("meta")))
    except (KeyError, ValueError, RecursionError) as error:
        raise InputFileError(f"{path}: no record ({reason_of(error)}); allowed: a file that `arena run` wrote") from error
    if isinstance(meta, dict) and meta.get("format") != FORMAT:
        raise InputFileError(f"{path}: format is {one_line(repr(meta.get('format')), 40)}; allowed: {FORMAT}")
    if fault := fault_of(arrays, meta):
        raise InputFileError(f"{path}: no record ({one_line(fault)}); allowed: a file that `arena run` wrote")
    timing = _read_timing(timing_of(path))
    rows_first = {name: np.ascontiguousarray(array) for name, array in arrays.items()}  # as they were before they were written
    return EpisodeRecord(rows_first, meta, timing)


def _read_timing(path: Path) -> dict[str, NDArray[np.float64]]:
    arrays = _read_npz(path) if path.exists() else {}
    if fault := fault_of_timing(arrays):
        raise InputFileError(f"{path}: no times ({one_line(fault)}); allowed: a file that `arena run` wrote")
    return arrays


def find_runs(directory: AnyPath) -> list[Path]:
    """Return every run's folder at or below ``directory``, sorted; raise InputFileError when there is none."""
    directory = Path(directory)
    try:
        there = directory.is_dir()
    except (OSError, ValueError) as error:  # a name that is too long, or that none can have
        raise InputFileError(f"{one_line(str(directory), 200)}: cannot be read ({reason_of(error)})") from None
    if not there:
        raise InputFileError(f"{directory}: no such folder; allowed: a folder that `arena run` wrote, or one above it")
    runs = sorted(path.parent for path in directory.rglob("episodes.csv"))
    if not runs:
        raise InputFileError(f"{directory}: no run below it (no episodes.csv); allowed: a folder that `arena run` wrote, or one above it")
    return runs


def check_inside(folder: AnyPath, path: AnyPath) -> None:
    """Raise InputFileError where a path leads out of a folder, by .. or by a link."""
    try:
        real, root = Path(path).resolve(), Path(folder).resolve()
    except (OSError, ValueError, RuntimeError) as error:  # RuntimeError: links in a circle; ValueError: a null
        raise InputFileError(f"{path}: cannot be found ({reason_of(error)}); allowed: a file inside {folder}") from None
    if not real.is_relative_to(root):
        raise InputFileError(f"{path}: leads out of {folder}; allowed: files inside it")


def write_grid(folder: Path, grid: OccupancyGrid) -> str:
    """Write a map once as ``worlds/HASH.npz`` (data, resolution, origin) and return that relative name."""
    origin = grid.origin.array()
    digest = blake2b(grid.data.tobytes() + repr((grid.data.shape, grid.resolution, origin.tolist())).encode(), digest_size=8).hexdigest()
    name = f"worlds/{digest}.npz"
    check_inside(folder, folder / name)
    if not (folder / name).exists():
        content = {"data": grid.data, "resolution": np.array(grid.resolution), "origin": origin}
        write_whole(folder / name, lambda file: _write_npz(file, content))
    return name


def read_grid(path: AnyPath) -> OccupancyGrid:
    """Read a run's map, ``worlds/HASH.npz``; raise InputFileError when it is missing, damaged or leads out of the run's folder."""
    path, allowed = Path(path), "the maps that `arena run` wrote beside the records"
    check_inside(path.parent.parent, path)
    content = read_arrays(path, allowed)
    try:
        data, resolution, origin = content["data"], float(content["resolution"]), content["origin"].astype(np.float64)
    except (KeyError, TypeError, ValueError) as error:
        raise InputFileError(f"{path}: damaged ({one_line(repr(error))}); allowed: {allowed}") from None
    fits = data.ndim == 2 and data.dtype == np.int8 and data.size <= LIMITS.cells and origin.shape == (3,)
    known = 0.0 < resolution <= LIMITS.number_largest and (np.abs(origin) <= LIMITS.record_farthest).all()
    if not (fits and known):
        raise InputFileError(f"{path}: damaged (its arrays are not those of a map); allowed: {allowed}")
    return OccupancyGrid(data, resolution, Pose.of(origin))


def write_whole(path: AnyPath, write: Callable[[IO[bytes]], object]) -> None:
    """Write a file beside its place, have the disk take it, and rename it: no half-written file is ever seen, not after a power cut either.

    Raises RunFolderError with the file and the reason (no space left, not writable).
    """
    path = Path(path)
    temporary = path.parent / f".{path.name}.{token_hex(4)}"  # named before it is made: Ctrl-C may come right after
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with temporary.open("xb") as file:
            write(file)
            file.flush()
            os.fchmod(file.fileno(), 0o644)
            os.fsync(file.fileno())
        temporary.replace(path)
        _sync_folder(path.parent)
    except BaseException as error:
        with suppress(OSError):
            temporary.unlink()
        if isinstance(error, OSError):
            raise RunFolderError(f"cannot write {path}: {error.strerror or error}") from error
        raise


def write_text_whole(path: AnyPath, text: str) -> None:
    """Write a text file as ``write_whole`` does, UTF-8, with escapes in place of what UTF-8 has not (lone surrogates)."""
    write_bytes_whole(path, text.encode(errors="backslashreplace"))


def write_bytes_whole(path: AnyPath, content: bytes) -> None:
    """Write a file as ``write_whole`` does."""
    write_whole(path, lambda file: file.write(content))


def keep_room(folder: Path, size: int) -> None:
    """Keep so many bytes of the disk free for a table, as far as they are there: ``remove_half_written`` gives them back."""
    with suppress(OSError), (folder / ROOM).open("xb") as file:
        file.write(bytes(size))


def remove_half_written(folder: Path) -> None:
    """Remove what killed writers left in a run's folder, and the room that was kept; nobody may be writing there."""
    parts = [folder / name for name in PARTS]
    shards = [place for part in parts if part.is_dir() for place in sorted(part.iterdir()) if NUMBERED.fullmatch(place.name)]
    for place in (folder, folder / "worlds", *parts, *shards):
        for path in place.glob(".*") if place.is_dir() and place.resolve().is_relative_to(folder.resolve()) else ():
            if HALF_WRITTEN.fullmatch(path.name) and path.is_file():
                with suppress(OSError):  # where nothing can be removed, it stays and harms nobody
                    path.unlink()


def _sync_folder(folder: Path) -> None:
    """Have the disk take a folder's names, too; not every file system can."""
    with suppress(OSError):
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)


def _write_npz(file: IO[bytes], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write arrays as ``np.savez_compressed`` does, with the quickest compression; rounded ones column by column: they pack better."""
    with ZipFile(file, "w") as archive:
        for name, array in arrays.items():
            content = io.BytesIO()
            np.lib.format.write_array(content, np.asfortranarray(array) if name in GRAIN else np.asanyarray(array), allow_pickle=False)
            member = ZipInfo(f"{name}.npy")  # dated 1980: equal records are equal files
            member.external_attr = 0o600 << 16
            archive.writestr(member, content.getbuffer(), ZIP_DEFLATED, 1)


def rounded(arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Return a record's arrays rounded to their grain, so that metrics are of what the file holds."""
    return {**arrays, **{name: _to_grain(arrays[name], places) for name, places in GRAIN.items() if name in arrays}}


def _to_grain(array: NDArray[Any], places: int) -> NDArray[Any]:
    """Round to so many binary places, exactly; what is no number or infinite stays, and there is no negative zero."""
    rounded: NDArray[Any] = np.ldexp(np.rint(np.ldexp(array, places)), -places) + array.dtype.type(0.0)
    return rounded


def _read_npz(path: Path) -> dict[str, Any]:
    return read_arrays(path, "a file that `arena run` wrote")


def _truth_arrays(states: list[WorldState]) -> dict[str, NDArray[Any]]:
    return {
        "stamp": np.array([s.stamp for s in states]),
        "pose": np.array([s.pose.array() for s in states]),
        "twist": np.array([s.twist.array() for s in states]),
        "clearance": np.array([s.clearance for s in states]),
        "clearance_people": np.array([s.clearance_people for s in states]),
        "in_contact": np.array([s.in_contact for s in states]),
        "contact_time": np.array([s.contact_time for s in states]),
    }


def _decision_arrays(decisions: list[Decision], last: Decision | None) -> dict[str, NDArray[Any]]:
    """Stack what was decided; the final row has no command, and no estimate either when the episode ended by an error."""
    nothing = np.full(3, np.nan)
    final = last.estimate.pose.array() if last else nothing
    covariance = last.estimate.covariance if last else np.full((3, 3), np.nan)
    waypoint = last.waypoint.array() if last else nothing
    return {
        "estimate": np.array([*(d.estimate.pose.array() for d in decisions), final]),
        "estimate_covariance": np.array([*(d.estimate.covariance for d in decisions), covariance], dtype=np.float32),
        "command": np.array([*(d.command.array() for d in decisions), nothing]),
        "waypoint": np.array([*(d.waypoint.array() for d in decisions), waypoint]),
    }


def _people_arrays(states: list[WorldState]) -> dict[str, NDArray[Any]]:
    people = [s.pedestrians for s in states]
    return {
        "pedestrian_ids": people[0].ids,
        "pedestrian_radii": people[0].radii,
        "pedestrian_positions": np.array([p.positions for p in people], dtype=np.float32),
        "pedestrian_velocities": np.array([p.velocities for p in people], dtype=np.float32),
        "pedestrian_states": np.array([p.states for p in people], dtype=np.int8),
    }


def _route_arrays(ids: NDArray[Any], people: Sequence[PedestrianSpec]) -> dict[str, NDArray[Any]]:
    """Return where everybody was to go: nowhere for those of whom the scenario does not say."""
    waypoints = {person.id: person.waypoints_xy for person in people}
    routes = [waypoints.get(number, np.empty((0, 2))) for number in ids.tolist()]
    return {
        "route_points": np.concatenate([np.empty((0, 2)), *routes]),
        "route_offsets": np.cumsum([0, *map(len, routes)], dtype=np.int64),
    }


def _contact_arrays(contacts: list[Contact]) -> dict[str, NDArray[Any]]:
    return {
        "contact_stamp": np.array([c.stamp for c in contacts], dtype=np.float64),
        "contact_kind": np.array([CONTACT_KINDS.index(c.kind) for c in contacts], dtype=np.int8),
        "contact_person": np.array([c.person for c in contacts], dtype=np.int32),
        "contact_speed": np.array([c.speed for c in contacts], dtype=np.float64),
        "contact_caused": np.array([c.caused for c in contacts], dtype=np.bool_),
        "contact_position": np.array([(c.x, c.y) for c in contacts], dtype=np.float64).reshape(-1, 2),
    }


def _path_arrays(decisions: list[Decision]) -> dict[str, NDArray[Any]]:
    planned: list[tuple[float, GlobalPath]] = [(d.events[0].stamp, d.planned) for d in decisions if d.planned is not None]
    lengths = [len(path.poses) for _, path in planned]
    return {
        "path_poses": np.concatenate([path.poses for _, path in planned]) if planned else np.empty((0, 3)),
        "path_offsets": np.cumsum([0, *lengths], dtype=np.int64),
        "path_stamps": np.array([stamp for stamp, _ in planned], dtype=np.float64),
    }


def _timing_arrays(decisions: list[Decision]) -> dict[str, NDArray[np.float64]]:
    """Return ``PART_seconds`` and ``PART_cpu_seconds`` of every part that was timed, one a decision."""
    seconds = {part: np.array([getattr(d.spent, part) for d in decisions], dtype=np.float64) for part in Spent.__slots__}
    return {f"{part}_seconds": _to_grain(array, TIME_GRAIN) for part, array in seconds.items()}


def whole_timing(spent: Duration) -> dict[str, NDArray[np.float64]]:
    """Return what a whole episode took, as arrays of one element beside those of its steps."""
    took = {"episode_seconds": spent.wall, "episode_cpu_seconds": spent.cpu}
    return {name: _to_grain(np.array([seconds]), TIME_GRAIN) for name, seconds in took.items()}


def _event(event: Event) -> dict[str, Any]:
    return {"stamp": event.stamp, "kind": event.kind, "detail": event.detail}


def _pose(pose: Pose) -> list[float]:
    return [pose.x, pose.y, pose.theta]


def _scenario_meta(scenario: Scenario) -> dict[str, Any]:
    obstacles = [{"vertices_xy": o.vertices_xy.tolist(), "radius": o.radius} for o in scenario.obstacles]
    return {
        "name": scenario.name,
        "seed": scenario.seed,
        "start": _pose(scenario.start),
        "goal": _pose(scenario.goal),
        "goal_radius": scenario.goal_radius,
        "time_limit": scenario.time_limit,
        "reference_length": scenario.reference_length,
        "pedestrian_types": {str(p.id): p.behaviour["type"] for p in scenario.pedestrians if "type" in p.behaviour},
        "speed_share": scenario.speed_share,
        "obstacles": obstacles,
        **({"furniture": list(map(furniture_meta, scenario.world.furniture))} if scenario.world.furniture else {}),
    }


def robot_meta(robot: Robot) -> dict[str, Any]:
    """Return what a record says of its robot."""
    limits = {name: getattr(robot.limits, name) for name in robot.limits.__slots__}
    footprint = {"radius": robot.footprint.radius, "vertices_xy": robot.footprint.vertices_xy.tolist()}
    return {
        "name": robot.name,
        "kinematics": robot.kinematics,
        "footprint": footprint,
        "limits": limits,
        "control_period": robot.control_period,
    }
