"""``arena ros import``: recordings become a run's folder, with records, metrics and everything that reads them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError, EpisodeRecord, InputFileError, OccupancyGrid, Pose, Robot
from arena_core.commands import one_line, print_notice
from arena_core.hosting import Code, OutsideRun, Registry, compose, load_registry, to_plain
from arena_core.scenes import free_area
from arena_ros.bags.bag_readers import open_bags
from arena_ros.bags.clocks import Clocks, read_clocks
from arena_ros.bags.episode_messages import EpisodeMessages
from arena_ros.bags.episode_reader import EpisodeReader
from arena_ros.bags.jump_split import JumpLimits, split_at_jumps
from arena_ros.bags.legacy import ENDING, LegacyFile, legacy_record
from arena_ros.bags.message_handler import ScanReading
from arena_ros.bags.people_tracking import PeopleTracker
from arena_ros.bags.records import EpisodeIdentity, Reading, foreign_record, restore_record
from arena_ros.bags.stream import Bag, Channel
from arena_ros.bags.topic_roles import RoleAssignment, assign_roles
from arena_ros.bags.transformed_episode import EpisodeTransformer, TransformedEpisode
from arena_ros.codec import BadMessage, get_codec

ROBOT = "turtlebot3"  # whose footprint counts where no one says which robot it was
MOTION = ("reference", "odometry", "estimate", "tf")


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """What is imported and how: roles said by the user, the robot's name or None, the planner's name, and whether scans
    are kept.

    ``goal`` is that of recordings which have none; with ``tracker`` people are those that our tracker sees in the
    scans. ``map_frame`` names the frame that all is taken to, and others that are taken for it.
    """

    roles: Mapping[str, str]
    robot: str | None
    planner: str
    map: Path | None
    scans: bool
    reading: Reading
    goal: Pose | None = None
    tracker: bool = False
    map_frame: tuple[str, ...] = ()


def import_bags(paths: Sequence[Path], folder: Path, request: Request) -> Sequence[Mapping[str, Any]]:
    """Write what was recorded to a run's folder; return the rows of its episodes.

    What was guessed, left out or is not known is told.
    """
    if paths and all(path.suffix == ENDING for path in paths):
        return _import_legacy(paths, folder, request)
    with open_bags(paths) as bags:
        return _import_recordings(bags, paths, folder, request)


def _import_recordings(
    bags: Sequence[Bag], paths: Sequence[Path], folder: Path, request: Request
) -> Sequence[Mapping[str, Any]]:
    channels: dict[Channel, int] = {}
    for bag in bags:
        for channel, count in bag.channels().items():
            channels[channel] = channels.get(channel, 0) + count
    found = assign_roles(channels, request.roles)
    tracked = request.tracker and not _is_export(found)
    if tracked:
        found = RoleAssignment(
            {role: channel for role, channel in found.by_role.items() if role != "people"}, found.guesses
        )
    if not any(role in found.by_role for role in MOTION):
        types = ", ".join(sorted({channel.type for channel in channels})) or "none"
        cut = next((f"; {bag.name}: {bag.cut}" for bag in bags if bag.cut), "")
        raise InputFileError(
            f"{paths[0]}: nothing says where the robot was (types: {one_line(types)}{cut}); "
            "allowed: a nav_msgs/Odometry, /amcl_pose, /tf or a reference pose"
        )
    registry = load_registry()
    config = _config_of_export(bags, found)
    exported = config is not None
    if config is None:
        for line in found.guesses:
            print_notice(line)
        config = _run_config(request)
    robot = registry.build("robot", config["robot"])
    grid = _site_grid(registry, config, request)
    watcher = _make_tracker(registry, config, robot, grid, found) if tracked else None
    times = Clocks(None, ("", ""), {}, [True] * len(bags)) if exported else read_clocks(bags, found)
    for line in times.lines:
        print_notice(line)
    reading = ScanReading(robot.footprint, robot.lidar.mount, watcher, request.map_frame, request.scans)
    gatherer = EpisodeReader(found, times, reading)
    with OutsideRun(folder, config, registry, Code("", {}), _import_notes(paths, found)) as run:
        for record in _episode_records(gatherer, bags, _Import(request, robot, config, run), grid):
            run.add(record)
    if times.off:
        gatherer.note(f"{times.off} stamps lie off their clock; the time of recording counts for them")
    _print_notes(gatherer, bags)
    if not run.rows:
        raise InputFileError(
            f"{paths[0]}: holds no episode, as nothing says where the robot was; allowed: a recording in which it moves"
        )
    return run.rows


@dataclass(frozen=True, slots=True, eq=False)
class _Import:
    """What was asked for, the robot that is taken for the one recorded, and the run that the records go to."""

    request: Request
    robot: Robot
    config: Mapping[str, Any]
    run: OutsideRun

    def next_identity(self, grid: OccupancyGrid | None) -> EpisodeIdentity:
        """Return what tells the next episode from others."""
        columns = _record_columns(self.config) | ({"pedestrian_model": "tracked"} if self.request.tracker else {})
        return EpisodeIdentity(len(self.run.rows), columns, _world_meta(self.config, self.run, grid))


def _episode_records(
    gatherer: EpisodeReader, bags: Sequence[Bag], to: _Import, site: OccupancyGrid | None
) -> Iterator[EpisodeRecord]:
    request = to.request
    placer = EpisodeTransformer(request.map_frame[0] if request.map_frame else "", gatherer.note)
    for gathered in gatherer.episodes(bags):
        grid = site if site is not None else gatherer.grid
        if gathered.meta is not None:
            yield _own_record(gathered, _world_meta(to.config, to.run, grid), len(to.run.rows))
        elif (placed := placer.transform_episode(gathered, gatherer.grid_frame, request.goal)) is not None:
            grid = _shift_grid(grid, placed.shift)
            limits = JumpLimits(_top_speed(to.robot), request.reading.goal_radius, request.reading.time_limit)
            for part in split_at_jumps(placed, limits, gatherer.note, is_later=bool(to.run.rows)):
                yield _foreign_episode(part, to, to.next_identity(grid))


def _foreign_episode(part: TransformedEpisode, to: _Import, identity: EpisodeIdentity) -> EpisodeRecord:
    record = foreign_record(part, to.robot, to.request.reading, identity)
    if part.goal is None:
        print_notice("no goal was recorded: where the robot was at the end counts as its goal")
    if part.truth != "reference":
        print_notice(f"no reference pose was recorded: what counts as true is {_TRUTH[part.truth]}")
    _print_unknown(record)
    return EpisodeRecord(record.arrays, {**record.meta, "config": dict(to.config)})


def _top_speed(robot: Robot) -> float:
    return max(abs(robot.limits.vx_max), abs(robot.limits.vy_max))


def _shift_grid(grid: OccupancyGrid | None, shift: tuple[float, float]) -> OccupancyGrid | None:
    if grid is None or not any(shift):
        return grid
    return replace(grid, origin=Pose(grid.origin.x - shift[0], grid.origin.y - shift[1], grid.origin.theta))


def _site_grid(registry: Registry, config: Mapping[str, Any], request: Request) -> OccupancyGrid | None:
    return registry.build("world", config["world"]).world(0, 0).grid if request.map is not None else None


def _is_export(found: RoleAssignment) -> bool:
    """Tell, and say, that a recording in which people are to be looked for is an export of ours."""
    if "episode" in found.by_role:
        print_notice("people=tracker is left out: an export of ours has its people itself")
    return "episode" in found.by_role


def _make_tracker(
    registry: Registry, config: Mapping[str, Any], robot: Any, grid: OccupancyGrid | None, found: RoleAssignment
) -> PeopleTracker:
    """Return what sees people in scans; raise ConfigurationError where there are none to look at."""
    if "scan" not in found.by_role:
        raise ConfigurationError("people is tracker, but no scan was recorded; allowed: a topic, or none")
    print_notice("people are those whom our tracker saw in the scans: who stands long, or is hidden, is not among them")
    return PeopleTracker(registry.build("tracker", config["tracker"], robot=robot), grid)


def _import_legacy(paths: Sequence[Path], folder: Path, request: Request) -> Sequence[Mapping[str, Any]]:
    """Write the records of Arena-Bench's recorder to a run's folder."""
    if request.roles or request.tracker or request.scans:
        raise ConfigurationError(
            f"{paths[0]}: has no topics and no scans; allowed beside CSV: out, robot, planner, map, goal and limits"
        )
    registry, config = load_registry(), _run_config(request)
    robot, grid = registry.build("robot", config["robot"]), _site_grid(registry, config, request)
    files = [LegacyFile(path) for path in paths]
    if request.goal is None:
        print_notice("no goal was recorded: where the robot was at the end counts as its goal (goal=X,Y says it)")
    with OutsideRun(
        folder, config, registry, Code("", {}), [f"imported from {', '.join(path.name for path in paths)}"]
    ) as run:
        world = _world_meta(config, run, grid)
        for episode in (each for file in files for each in file.episodes()):
            number = len(run.rows)
            record = legacy_record(
                episode, request.goal, robot, request.reading, EpisodeIdentity(number, _record_columns(config), world)
            )
            _print_unknown(record)
            run.add(EpisodeRecord(record.arrays, {**record.meta, "config": dict(config)}))
    for file in files:
        if file.left_out:
            print_notice(f"{file.path}: {file.left_out} rows are no numbers or do not go on in time; left out")
    if not run.rows:
        raise InputFileError(f"{paths[0]}: holds no episode; allowed: a file with two rows of one at least")
    return run.rows


def _world_meta(config: Mapping[str, Any], run: OutsideRun, grid: OccupancyGrid | None) -> dict[str, Any]:
    world: dict[str, Any] = {"name": config["world"]["name"], "known": grid is not None}
    return world if grid is None else world | {"grid": run.grid(grid), "free_area": grid.derive(free_area)}


def _print_unknown(record: EpisodeRecord) -> None:
    for reason in sorted(set(record.meta["unknown"].values())):
        arrays = [name for name, why in record.meta["unknown"].items() if why == reason]
        print_notice(f"metrics of {', '.join(arrays)} stay empty: {reason}")


_TRUTH = {"estimated": "the robot's own estimate", "odometry": "its odometry, which drifts"}


def _own_record(gathered: EpisodeMessages, world: Mapping[str, Any], number: int) -> EpisodeRecord:
    try:
        record = restore_record(gathered)
        own = {**record.meta["world"], **{key: world[key] for key in ("grid",) if key in world}}
        return EpisodeRecord(record.arrays, {**record.meta, "world": own})
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise InputFileError(
            f"/arena/episode: episode {number} is not as `arena ros export` writes it ({error})"
        ) from None


def _config_of_export(bags: Sequence[Bag], found: RoleAssignment) -> dict[str, Any] | None:
    """Return the configuration of the run that was exported; None where the recording is not an export of ours."""
    channel = found.by_role.get("episode")
    if channel is None:
        return None
    for bag in bags:
        for _, _, content in bag.messages({channel.topic}):
            try:
                own = json.loads(get_codec(channel.ros).decode(content, channel.type).data)["meta"]["config"]
            except (BadMessage, ValueError, KeyError, TypeError):
                return None
            usual = to_plain(compose(()))
            return {**usual, **own} if isinstance(own, dict) and "robot" in own else None
    return None


def _run_config(request: Request) -> dict[str, Any]:
    """Return the configuration of the run: the robot's, the map's, and names for the rest."""
    name = request.robot or ROBOT
    if request.robot is None:
        print_notice(f"no robot is said: footprint and limits are those of {ROBOT} (robot=NAME says another)")
    world = ["world=ros_map", f"world.path={request.map}"] if request.map is not None else []
    config = to_plain(compose([f"robot={name}", *world]))
    config["planner"], config["simulator"] = {"name": request.planner}, {"name": "real"}
    config["localizer"], config["pedestrians"], config["task"] = ({"name": "recorded"} for _ in range(3))
    if request.map is None:
        config["world"] = {"name": "recorded"}
    config.pop("choices", None)
    return config


def _record_columns(config: Mapping[str, Any]) -> dict[str, Any]:
    names = {
        "planner": "planner",
        "preset": "planner",
        "robot": "robot",
        "simulator": "simulator",
        "world": "world",
        "task": "task",
    }
    found: dict[str, Any] = {column: config[key]["name"] for column, key in names.items()}
    rest = {
        "scenario_hash": "",
        "stage": None,
        "pedestrian_model": "recorded",
        "reaction": "",
        "localizer": "recorded",
        "timing": "real",
    }
    return {**found, **rest, "seed": config["seed"]}


def _import_notes(paths: Sequence[Path], found: RoleAssignment) -> list[str]:
    played = [f"{role}: {channel.topic}" for role, channel in sorted(found.by_role.items())]
    return [f"imported from {', '.join(path.name for path in paths)}", *played]


def _print_notes(gatherer: EpisodeReader, bags: Sequence[Bag]) -> None:
    for bag in bags:
        if bag.cut:
            print_notice(f"{bag.name}: {bag.cut}; what came before is kept")
        if bag.repeated:
            print_notice(f"{bag.name}: {bag.repeated} messages stand there twice; each counts once")
    for line, count in gatherer.notes.items():
        print_notice(line + (f" ({count} times)" if count > 1 else ""))


def reading_of(period: float, goal_radius: float, time_limit: float, person_radius: float, without: str) -> Reading:
    """Return how to read a foreign recording; raise ConfigurationError."""
    parts = frozenset(part for part in without.split(",") if part)
    wrong = sorted(parts - {"people", "contacts"})
    if wrong:
        raise ConfigurationError(f"without has {wrong[0]}; allowed: people, contacts")
    if not 0.005 <= period <= 60.0:
        raise ConfigurationError(f"period is {period}; allowed: 0.005 to 60 s")
    return Reading(period, goal_radius, time_limit, person_radius, parts)
