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
from arena_ros.bags.clocks import Clocks, clocks
from arena_ros.bags.gathered import Gathered
from arena_ros.bags.gathering import Gatherer
from arena_ros.bags.legacy import ENDING, LegacyFile, legacy_record
from arena_ros.bags.opening import open_bags
from arena_ros.bags.parting import parts
from arena_ros.bags.placing import Placed, Placer
from arena_ros.bags.records import Reading, measured, restored
from arena_ros.bags.roles import Cast, cast
from arena_ros.bags.stream import Bag, Channel
from arena_ros.bags.watching import Watcher
from arena_ros.codec import BadMessage, codec

ROBOT = "turtlebot3"  # whose footprint counts where nobody says which robot it was
MOTION = ("reference", "odometry", "estimate", "tf")


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """What is imported and how: roles said by the user, the robot's name or None, the planner's name, and whether scans are kept.

    ``goal`` is that of recordings which have none; with ``tracker`` people are those that our tracker sees in the scans.
    ``map_frame`` names the frame that all is taken to, and others that are taken for it.
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
    """Write what was recorded to a run's folder; return the rows of its episodes. What was guessed, left out or is not known is told."""
    if paths and all(path.suffix == ENDING for path in paths):
        return _import_legacy(paths, folder, request)
    with open_bags(paths) as bags:
        return _import(bags, paths, folder, request)


def _import(bags: Sequence[Bag], paths: Sequence[Path], folder: Path, request: Request) -> Sequence[Mapping[str, Any]]:
    channels: dict[Channel, int] = {}
    for bag in bags:
        for channel, count in bag.channels().items():
            channels[channel] = channels.get(channel, 0) + count
    found = cast(channels, request.roles)
    tracked = request.tracker and not _is_export(found)
    if tracked:
        found = Cast({role: channel for role, channel in found.by_role.items() if role != "people"}, found.guesses)
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
        config = _config(request)
    robot = registry.build("robot", config["robot"])
    grid = _site(registry, config, request)
    watcher = _watcher(registry, config, robot, grid, found) if tracked else None
    times = Clocks(None, ("", ""), {}, [True] * len(bags)) if exported else clocks(bags, found)
    for line in times.lines:
        print_notice(line)
    gatherer = Gatherer(found, times, robot.footprint, robot.lidar.mount, request.scans, watcher, request.map_frame)
    with OutsideRun(folder, config, registry, Code("", {}), _notes(paths, found)) as run:
        for record in _records(gatherer, bags, request, robot, config, run, grid):
            run.add(record)
    if times.off:
        gatherer.note(f"{times.off} stamps lie off their clock; the time of recording counts for them")
    _tell(gatherer, bags)
    if not run.rows:
        raise InputFileError(f"{paths[0]}: holds no episode, as nothing says where the robot was; allowed: a recording in which it moves")
    return run.rows


def _records(
    gatherer: Gatherer,
    bags: Sequence[Bag],
    request: Request,
    robot: Robot,
    config: Mapping[str, Any],
    run: OutsideRun,
    grid: OccupancyGrid | None,
) -> Iterator[EpisodeRecord]:
    placer = Placer(request.map_frame[0] if request.map_frame else "", gatherer.note)
    for gathered in gatherer.episodes(bags):
        if gathered.meta is not None:
            yield _own(gathered, _world(config, run, grid if grid is not None else gatherer.grid), len(run.rows))
        elif (placed := placer.place(gathered, gatherer.grid_frame, request.goal)) is not None:
            reading, site = request.reading, _shifted(grid if grid is not None else gatherer.grid, placed.shift)
            for part in parts(placed, bool(run.rows), _fastest(robot), reading.goal_radius, reading.time_limit, gatherer.note):
                yield _measured(part, robot, request, config, len(run.rows), _world(config, run, site))


def _measured(
    part: Placed, robot: Robot, request: Request, config: Mapping[str, Any], number: int, world: Mapping[str, Any]
) -> EpisodeRecord:
    columns = _columns(config) | ({"pedestrian_model": "tracked"} if request.tracker else {})
    record = measured(part, robot, request.reading, number, columns, world)
    if part.goal is None:
        print_notice("no goal was recorded: where the robot was at the end counts as its goal")
    if part.truth != "reference":
        print_notice(f"no reference pose was recorded: what counts as true is {_TRUTH[part.truth]}")
    _tell_unknown(record)
    return EpisodeRecord(record.arrays, {**record.meta, "config": dict(config)})


def _fastest(robot: Robot) -> float:
    return max(abs(robot.limits.vx_max), abs(robot.limits.vy_max))


def _shifted(grid: OccupancyGrid | None, shift: tuple[float, float]) -> OccupancyGrid | None:
    if grid is None or not any(shift):
        return grid
    return replace(grid, origin=Pose(grid.origin.x - shift[0], grid.origin.y - shift[1], grid.origin.theta))


def _site(registry: Registry, config: Mapping[str, Any], request: Request) -> OccupancyGrid | None:
    return registry.build("world", config["world"]).world(0, 0).grid if request.map is not None else None


def _is_export(found: Cast) -> bool:
    """Tell, and say, that a recording in which people are to be looked for is an export of ours."""
    if "episode" in found.by_role:
        print_notice("people=tracker is left out: an export of ours has its people itself")
    return "episode" in found.by_role


def _watcher(registry: Registry, config: Mapping[str, Any], robot: Any, grid: OccupancyGrid | None, found: Cast) -> Watcher:
    """Return what sees people in scans; raise ConfigurationError where there are none to look at."""
    if "scan" not in found.by_role:
        raise ConfigurationError("people is tracker, but no scan was recorded; allowed: a topic, or none")
    print_notice("people are those whom our tracker saw in the scans: who stands long, or is hidden, is not among them")
    return Watcher(registry.build("tracker", config["tracker"], robot=robot), grid)


def _import_legacy(paths: Sequence[Path], folder: Path, request: Request) -> Sequence[Mapping[str, Any]]:
    """Write the records of Arena-Bench's recorder to a run's folder."""
    if request.roles or request.tracker or request.scans:
        raise ConfigurationError(f"{paths[0]}: has no topics and no scans; allowed beside CSV: out, robot, planner, map, goal and limits")
    registry, config = load_registry(), _config(request)
    robot, grid = registry.build("robot", config["robot"]), _site(registry, config, request)
    files = [LegacyFile(path) for path in paths]
    if request.goal is None:
        print_notice("no goal was recorded: where the robot was at the end counts as its goal (goal=X,Y says it)")
    with OutsideRun(folder, config, registry, Code("", {}), [f"imported from {', '.join(path.name for path in paths)}"]) as run:
        world = _world(config, run, grid)
        for episode in (each for file in files for each in file.episodes()):
            number = len(run.rows)
            record = legacy_record(episode, request.goal, robot, request.reading, number, _columns(config), world)
            _tell_unknown(record)
            run.add(EpisodeRecord(record.arrays, {**record.meta, "config": dict(config)}))
    for file in files:
        if file.left_out:
            print_notice(f"{file.path}: {file.left_out} rows are no numbers or do not go on in time; left out")
    if not run.rows:
        raise InputFileError(f"{paths[0]}: holds no episode; allowed: a file with two rows of one at least")
    return run.rows


def _world(config: Mapping[str, Any], run: OutsideRun, grid: OccupancyGrid | None) -> dict[str, Any]:
    world: dict[str, Any] = {"name": config["world"]["name"], "known": grid is not None}
    return world if grid is None else world | {"grid": run.grid(grid), "free_area": grid.derive(free_area)}


def _tell_unknown(record: EpisodeRecord) -> None:
    for reason in sorted(set(record.meta["unknown"].values())):
        arrays = [name for name, why in record.meta["unknown"].items() if why == reason]
        print_notice(f"metrics of {', '.join(arrays)} stay empty: {reason}")


_TRUTH = {"estimated": "the robot's own estimate", "odometry": "its odometry, which drifts"}


def _own(gathered: Gathered, world: Mapping[str, Any], number: int) -> EpisodeRecord:
    try:
        record = restored(gathered)
        own = {**record.meta["world"], **{key: world[key] for key in ("grid",) if key in world}}
        return EpisodeRecord(record.arrays, {**record.meta, "world": own})
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise InputFileError(f"/arena/episode: episode {number} is not as `arena ros export` writes it ({error})") from None


def _config_of_export(bags: Sequence[Bag], found: Cast) -> dict[str, Any] | None:
    """Return the configuration of the run that was exported; None where the recording is not an export of ours."""
    channel = found.by_role.get("episode")
    if channel is None:
        return None
    for bag in bags:
        for _, _, content in bag.messages({channel.topic}):
            try:
                own = json.loads(codec(channel.ros).decode(content, channel.type).data)["meta"]["config"]
            except (BadMessage, ValueError, KeyError, TypeError):
                return None
            usual = to_plain(compose(()))
            return {**usual, **own} if isinstance(own, dict) and "robot" in own else None
    return None


def _config(request: Request) -> dict[str, Any]:
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


def _columns(config: Mapping[str, Any]) -> dict[str, Any]:
    names = {"planner": "planner", "preset": "planner", "robot": "robot", "simulator": "simulator", "world": "world", "task": "task"}
    found: dict[str, Any] = {column: config[key]["name"] for column, key in names.items()}
    rest = {"scenario_hash": "", "stage": None, "pedestrian_model": "recorded", "reaction": "", "localizer": "recorded", "timing": "real"}
    return {**found, **rest, "seed": config["seed"]}


def _notes(paths: Sequence[Path], found: Cast) -> list[str]:
    played = [f"{role}: {channel.topic}" for role, channel in sorted(found.by_role.items())]
    return [f"imported from {', '.join(path.name for path in paths)}", *played]


def _tell(gatherer: Gatherer, bags: Sequence[Bag]) -> None:
    for bag in bags:
        if bag.cut:
            print_notice(f"{bag.name}: {bag.cut}; what came before is kept")
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
