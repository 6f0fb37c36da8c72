"""``arena ros``: what a user can do with ROS."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from arena_core import ConfigurationError
from arena_core.commands import Command, Words, read_words
from arena_core.files import write_text_whole
from arena_core.parameters import Positive
from arena_core.records import find_runs

if TYPE_CHECKING:
    from arena_ros.bags.importing import Request

USAGES = {
    "export": "arena ros export RUN out=FILE.bag|.mcap|.db3 [episodes=0,3]",
    "import": "arena ros import BAG... out=DIR [robot=NAME] [planner=NAME] [map=MAP.yaml] [people=tracker] "
    "[ROLE=/TOPIC] [...]",
    "scenario-from": "arena ros scenario-from BAG... out=SCENARIO.json [robot=NAME] [map=MAP.yaml] [ROLE=/TOPIC]",
    "drive": "arena ros drive planner=NAME robot=NAME map=MAP.yaml [transport=ros1] [namespace=/robot1] [goal=X,Y] "
    "[start=X,Y,THETA] [pose=/tf] [...]",
    "controller": "arena ros controller planner=NAME robot=NAME [transport=ros2] [map=MAP.yaml] [pose=/tf] "
    "[action=/follow_path] [controllers=FollowPath] [...]",
    "simulate": "arena ros simulate [transport=ros1] [episode=0] [rate=1.0] [lock_step=true] [action=/move_base] "
    "[KEY=VALUE ...]",
    "views": "arena ros views out=DIR",
    "watchdog": "arena ros watchdog [transport=ros1] [from=/arena/cmd_vel] [to=/cmd_vel]",
}
READING_KEYS = ("period", "goal_radius", "time_limit", "person_radius", "without")
IMPORT_KEYS = ("out", "robot", "planner", "map", "map_frame", "scans", *READING_KEYS)
VIEWS = (".rviz", ".json", ".xml")  # of RViz, Foxglove and Nav2
TRACKER = "tracker"  # what the role `people` may be beside a topic


class RosCommand(Command):
    """Bags in and out, driving a robot, being one."""

    help: ClassVar[str] = (
        "bags and robots of ROS 1 and ROS 2: "
        "arena ros export|import|scenario-from|drive|controller|simulate|views|watchdog ..."
    )

    def run(self, arguments: Sequence[str]) -> int:
        """Run what the first word says."""
        actions = _action_functions()
        if not arguments or arguments[0] not in actions:
            wanted = arguments[0] if arguments else "nothing"
            raise ConfigurationError(f"arena ros: {wanted} is no action; allowed: {', '.join(actions)}")
        return actions[arguments[0]](["dry_run=true" if word == "--dry-run" else word for word in arguments[1:]])

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the actions that fit."""
        return [name for name in _action_functions() if name.startswith(word)] if not words else ()


def _action_functions() -> Mapping[str, Callable[[Sequence[str]], int]]:
    return {
        "export": _run_export,
        "import": _run_import,
        "scenario-from": _run_scenario_from,
        "drive": _run_drive,
        "controller": _run_controller,
        "simulate": _run_simulate,
        "views": _run_views,
        "watchdog": _run_watchdog,
    }


def _run_views(arguments: Sequence[str]) -> int:
    """Write what shows our topics in RViz and Foxglove, and starts Nav2 with us; no file is written over."""
    words = read_words(USAGES["views"], arguments, keys=("out",))
    folder = Path(words.required("out"))
    views = [file for file in files("arena_ros").joinpath("views").iterdir() if file.name.endswith(VIEWS)]
    if there := sorted(view.name for view in views if (folder / view.name).exists()):
        raise ConfigurationError(f"{folder / there[0]} is there already; allowed: a folder without it")
    for view in sorted(views, key=lambda view: view.name):
        write_text_whole(folder / view.name, view.read_text(encoding="utf-8"))
        print(folder / view.name)
    return 0


def _run_export(arguments: Sequence[str]) -> int:
    from arena_ros.bags.exporting import export_run

    words = read_words(USAGES["export"], arguments, names=1, keys=("out", "episodes"))
    target, folder = Path(words.required("out")), Path(words.names[0])
    runs = find_runs(folder)
    if len(runs) > 1:
        raise ConfigurationError(f"{folder} holds {len(runs)} runs; allowed: the folder of one, such as {runs[0]}")
    count = export_run(runs[0], target, _episode_numbers(words))
    print(f"{target}: {count} episode{'s' * (count != 1)}, {target.stat().st_size / 1e6:.1f} MB")
    return 0


def _episode_numbers(words: Words) -> list[int] | None:
    text = words.keys.get("episodes")
    if text is None:
        return None
    parts = text.split(",")
    if not all(part.isdecimal() for part in parts):
        raise ConfigurationError(f"episodes is {text}; allowed: numbers with commas between them")
    return [int(part) for part in parts]


def _run_import(arguments: Sequence[str]) -> int:
    from arena_ros.bags.importing import import_bags

    words, request = _read_request("import", arguments)
    folder = Path(words.required("out"))
    rows = import_bags([Path(name) for name in words.names], folder, request)
    print(f"{folder}: {len(rows)} episode{'s' * (len(rows) != 1)}")
    return 0


def _run_scenario_from(arguments: Sequence[str]) -> int:
    from arena_ros.bags.scenarios import scenario_from

    words, request = _read_request("scenario-from", arguments)
    target = Path(words.required("out"))
    count = scenario_from([Path(name) for name in words.names], target, request)
    print(f"{target}: {count} problem{'s' * (count != 1)}")
    return 0


def _read_request(action: str, arguments: Sequence[str]) -> tuple[Words, Request]:
    """Return the words of an action that reads recordings, and what is asked for."""
    from arena_ros.bags.importing import Request, reading_of
    from arena_ros.bags.legacy import ENDING
    from arena_ros.bags.topic_roles import NONE, all_roles
    from arena_ros.pose_argument import read_pose

    words = read_words(USAGES[action], arguments, names=None, keys=(*IMPORT_KEYS, *all_roles()))
    if not words.names:
        raise ConfigurationError(f"no recording is given; allowed: {USAGES[action]}")
    reading = reading_of(
        words.value("period", Positive, 0.1),
        words.value("goal_radius", Positive, 1.0 if all(name.endswith(ENDING) for name in words.names) else 0.3),
        words.value("time_limit", Positive, 180.0),
        words.value("person_radius", Positive, 0.3),
        words.value("without", str, ""),
    )
    # `map` and `goal` are roles, too: a topic begins with a slash, a file has an ending, a place is of numbers
    where, place = words.keys.get("map"), words.keys.get("goal", NONE)
    topics = {key: value for key, value in words.keys.items() if key in all_roles()}
    if where is not None and where.endswith((".yaml", ".yml")):
        del topics["map"]
    goal = None if place == NONE or place.startswith("/") else read_pose(words, "goal")
    if goal is not None:
        del topics["goal"]
    tracked = topics.get("people") == TRACKER
    if tracked:
        del topics["people"]
    request = Request(
        topics,
        words.value("robot", str, None),
        words.value("planner", str, "recorded"),
        Path(where) if where is not None and "map" not in topics else None,
        words.value("scans", bool, False),
        reading,
        goal,
        tracked,
        tuple(name.lstrip("/") for name in words.value("map_frame", str, "").split(",") if name),
    )
    return words, request


def _run_drive(arguments: Sequence[str]) -> int:
    from arena_ros.live.commands import drive_robot

    return drive_robot(USAGES["drive"], arguments)


def _run_controller(arguments: Sequence[str]) -> int:
    from arena_ros.live.controller import serve_controller

    return serve_controller(USAGES["controller"], arguments)


def _run_simulate(arguments: Sequence[str]) -> int:
    from arena_ros.live.commands import simulate_robot

    return simulate_robot(USAGES["simulate"], arguments)


def _run_watchdog(arguments: Sequence[str]) -> int:
    from arena_ros.live.commands import run_watchdog

    return run_watchdog(USAGES["watchdog"], arguments)
