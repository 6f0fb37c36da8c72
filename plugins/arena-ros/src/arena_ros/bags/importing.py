"""``arena ros import``: recordings become a run's folder, with records, metrics and everything that reads them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arena_core import (
    Code,
    ConfigurationError,
    EpisodeRecord,
    InputFileError,
    OccupancyGrid,
    OutsideRun,
    Pose,
    Registry,
    compose,
    free_area,
    load_registry,
    plain,
    tell,
)
from arena_ros.bags.gathering import Gathered, Gatherer
from arena_ros.bags.legacy import ENDING, LegacyFile, legacy_record
from arena_ros.bags.opening import open_bags
from arena_ros.bags.records import Reading, measured, restored
from arena_ros.bags.roles import Cast, cast, definitions
from arena_ros.bags.stream import Bag, Channel
from arena_ros.bags.watching import Watcher
from arena_ros.codec import BadMessage, Codec

ROBOT = "turtlebot3"  # whose footprint counts where nobody says which robot it was
MOTION = ("reference", "odometry", "estimate")


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """What is imported and how: roles said by the user, the robot's name or None, the planner's name, and whether scans are kept.

    ``goal`` is that of recordings which have none; with ``tracker`` people are those that our tracker sees in the scans.
    """

    roles: Mapping[str, str]
    robot: str | None
    planner: str
    map: Path | None
    scans: bool
    reading: Reading
    goal: Pose | None = None
    tracker: bool = False


def import_bags(paths: Sequence[Path], folder: Path, request: Request) -> Sequence[Mapping[str, Any]]:
    """Write what was recorded to a run's folder; return the rows of its episodes. What was guessed, left out or is not known is told."""
    if paths and all(path.suffix == ENDING for path in paths):
        return _import_legacy(paths, folder, request)
    bags = open_bags(paths)
    channels: dict[Channel, int] = {}
    for bag in bags:
        for channel, count in bag.channels().items():
            channels[channel] = channels.get(channel, 0) + count
    found = cast(channels, request.roles)
    tracked = request.tracker and not _is_export(found)
    if tracked:
        found = Cast({role: channel for role, channel in found.by_role.items() if role != "people"}, found.guesses)
    if not any(role in found.by_role for role in MOTION):
        types = sorted({channel.type for channel in channels})
        raise InputFileError(
            f"{paths[0]}: nothing says where the robot was (types: {', '.join(types) or 'none'}); "
            "allowed: a nav_msgs/Odometry, /amcl_pose or a reference pose"
        )
    registry = load_registry()
    codec = Codec(bags[0].ros, definitions(channels))
    config = _config_of_export(bags, found, codec)
    if config is None:
        for line in found.guesses:
            tell(line)
        config = _config(request)
    robot = registry.build("robot", config["robot"])
    grid = _site(registry, config, request)
    watcher = _watcher(registry, config, robot, grid, found) if tracked else None
    gatherer = Gatherer(codec, found, robot.footprint, robot.lidar.mount, request.scans, watcher)
    with OutsideRun(folder, config, registry, Code("", {}), _notes(paths, found)) as run:
        for record in _records(gatherer, bags, request, robot, config, run, grid):
            run.add(record)
    _tell(gatherer, bags, run)
    if not run.rows:
        raise InputFileError(f"{paths[0]}: holds no episode; allowed: a recording in which a robot moves")
    return run.rows


def _records(
    gatherer: Gatherer,
    bags: Sequence[Bag],
    request: Request,
    robot: Any,
    config: Mapping[str, Any],
    run: OutsideRun,
    grid: OccupancyGrid | None,
) -> Iterator[EpisodeRecord]:
    for number, gathered in enumerate(gatherer.episodes(bags)):
        world = _world(config, run, grid if grid is not None else gatherer.grid)
        if gathered.meta is not None:
            yield _own(gathered, world, number)
            continue
        gathered.goal = gathered.goal or request.goal
        columns = _columns(config) | ({"pedestrian_model": "tracked"} if request.tracker else {})
        record = measured(gathered, robot, request.reading, number, columns, world)
        if gathered.goal is None:
            tell("no goal was recorded: where the robot was at the end counts as its goal")
        if record.meta["truth"] != "reference":
            tell(f"no reference pose was recorded: what counts as true is {_TRUTH[record.meta['truth']]}")
        _tell_unknown(record)
        yield EpisodeRecord(record.arrays, {**record.meta, "config": dict(config)})


def _site(registry: Registry, config: Mapping[str, Any], request: Request) -> OccupancyGrid | None:
    return registry.build("world", config["world"]).world(0, 0).grid if request.map is not None else None


def _is_export(found: Cast) -> bool:
    """Tell, and say, that a recording in which people are to be looked for is an export of ours."""
    if "episode" in found.by_role:
        tell("people=tracker is left out: an export of ours has its people itself")
    return "episode" in found.by_role


def _watcher(registry: Registry, config: Mapping[str, Any], robot: Any, grid: OccupancyGrid | None, found: Cast) -> Watcher:
    """Return what sees people in scans; raise ConfigurationError where there are none to look at."""
    if "scan" not in found.by_role:
        raise ConfigurationError("people is tracker, but no scan was recorded; allowed: a topic, or none")
    tell("people are those whom our tracker saw in the scans: who stands long, or is hidden, is not among them")
    return Watcher(registry.build("tracker", config["tracker"], robot=robot), grid)


def _import_legacy(paths: Sequence[Path], folder: Path, request: Request) -> Sequence[Mapping[str, Any]]:
    """Write the records of Arena-Bench's recorder to a run's folder."""
    if request.roles or request.tracker or request.scans:
        raise ConfigurationError(f"{paths[0]}: has no topics and no scans; allowed beside CSV: out, robot, planner, map, goal and limits")
    registry, config = load_registry(), _config(request)
    robot, grid = registry.build("robot", config["robot"]), _site(registry, config, request)
    files = [LegacyFile(path) for path in paths]
    if request.goal is None:
        tell("no goal was recorded: where the robot was at the end counts as its goal (goal=X,Y says it)")
    with OutsideRun(folder, config, registry, Code("", {}), [f"imported from {', '.join(path.name for path in paths)}"]) as run:
        world = _world(config, run, grid)
        for episode in (each for file in files for each in file.episodes()):
            number = len(run.rows)
            record = legacy_record(episode, request.goal, robot, request.reading, number, _columns(config), world)
            _tell_unknown(record)
            run.add(EpisodeRecord(record.arrays, {**record.meta, "config": dict(config)}))
    for file in files:
        if file.left_out:
            tell(f"{file.path}: {file.left_out} rows are no numbers or do not go on in time; left out")
    if not run.rows:
        raise InputFileError(f"{paths[0]}: holds no episode; allowed: a file with two rows of one at least")
    return run.rows


def _world(config: Mapping[str, Any], run: OutsideRun, grid: OccupancyGrid | None) -> dict[str, Any]:
    world: dict[str, Any] = {"name": config["world"]["name"], "known": grid is not None}
    return world if grid is None else world | {"grid": run.grid(grid), "free_area": grid.derive(free_area)}


def _tell_unknown(record: EpisodeRecord) -> None:
    for reason in sorted(set(record.meta["unknown"].values())):
        arrays = [name for name, why in record.meta["unknown"].items() if why == reason]
        tell(f"metrics of {', '.join(arrays)} stay empty: {reason}")


_TRUTH = {"estimated": "the robot's own estimate", "odometry": "its odometry, which drifts"}


def _own(gathered: Gathered, world: Mapping[str, Any], number: int) -> EpisodeRecord:
    try:
        record = restored(gathered)
        own = {**record.meta["world"], **{key: world[key] for key in ("grid",) if key in world}}
        return EpisodeRecord(record.arrays, {**record.meta, "world": own})
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise InputFileError(f"/arena/episode: episode {number} is not as `arena ros export` writes it ({error})") from None


def _config_of_export(bags: Sequence[Bag], found: Cast, codec: Codec) -> dict[str, Any] | None:
    """Return the configuration of the run that was exported; None where the recording is not an export of ours."""
    channel = found.by_role.get("episode")
    if channel is None:
        return None
    for bag in bags:
        for _, _, content in bag.messages({channel.topic}):
            try:
                own = json.loads(codec.decode(content, channel.type).data)["meta"]["config"]
            except (BadMessage, ValueError, KeyError, TypeError):
                return None
            usual = plain(compose(()))
            return {**usual, **own} if isinstance(own, dict) and "robot" in own else None
    return None


def _config(request: Request) -> dict[str, Any]:
    """Return the configuration of the run: the robot's, the map's, and names for the rest."""
    name = request.robot or ROBOT
    if request.robot is None:
        tell(f"no robot is said: footprint and limits are those of {ROBOT} (robot=NAME says another)")
    world = ["world=ros_map", f"world.path={request.map}"] if request.map is not None else []
    config = plain(compose([f"robot={name}", *world]))
    config["planner"], config["simulator"] = {"name": request.planner}, {"name": "real"}
    config["localizer"], config["pedestrians"], config["task"] = ({"name": "recorded"} for _ in range(3))
    if request.map is None:
        config["world"] = {"name": "recorded"}
    config.pop("choices", None)
    return config


def _columns(config: Mapping[str, Any]) -> dict[str, Any]:
    names = {"planner": "planner", "preset": "planner", "robot": "robot", "simulator": "simulator", "world": "world", "task": "task"}
    found: dict[str, Any] = {column: config[key]["name"] for column, key in names.items()}
    rest = {"scenario_hash": "", "stage": None, "pedestrian_model": "recorded", "reaction": "", "localizer": "recorded", "timing": "real"}
    return {**found, **rest, "seed": config["seed"]}


def _notes(paths: Sequence[Path], found: Cast) -> list[str]:
    played = [f"{role}: {channel.topic}" for role, channel in sorted(found.by_role.items())]
    return [f"imported from {', '.join(path.name for path in paths)}", *played]


def _tell(gatherer: Gatherer, bags: Sequence[Bag], run: OutsideRun) -> None:
    for bag in bags:
        if bag.cut:
            tell(f"{bag.path}: {bag.cut}; what came before is kept")
    for line, count in gatherer.notes.items():
        tell(line + (f" ({count} times)" if count > 1 else ""))


def reading_of(period: float, goal_radius: float, time_limit: float, person_radius: float, without: str) -> Reading:
    """Return how to read a foreign recording; raise ConfigurationError."""
    parts = frozenset(part for part in without.split(",") if part)
    wrong = sorted(parts - {"people", "contacts"})
    if wrong:
        raise ConfigurationError(f"without has {wrong[0]}; allowed: people, contacts")
    return Reading(period, goal_radius, time_limit, person_radius, parts)
