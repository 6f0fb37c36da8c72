"""All that the suite reads: what reads a file of each kind, what lies about it, and how it is spoilt."""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from arena_core import World
from arena_core.loop.record_files import write_grid, write_record
from arena_core.records import read_record
from tests.fuzz import mutations as change
from tests.fuzz.samples import (
    CURRICULUM,
    DYNABARN,
    FLATLAND_WORLD,
    LINES,
    MAP,
    MJCF,
    MODEL,
    OURS,
    PACK,
    ROSNAV,
    SCENE,
    SOURCE,
    TOOLS,
    TRACKS,
    WALLS,
    const,
    dumped,
    gazebo,
    npy,
    picture,
    rollouts,
    room,
)

Change = Callable[[bytes], Any]
BYTES, TEXT, JSON, YAML, XML = (
    change.changed_bytes,
    change.changed_text,
    change.changed_json,
    change.changed_yaml,
    change.changed_xml,
)
NPZ, TABLE = change.changed_npz, change.changed_table
NUMBERS, DATA_BASE = change.changed_numbers, change.changed_data_base


@dataclass(frozen=True)
class Reader:
    """A kind of file: ``good`` are files of it, by name; ``read`` takes the spoilt one, which lies where a good one
    did.

    ``beside`` writes what a file of the kind needs about it; ``share`` of the inputs that others get go to one that
    takes long.
    """

    good: dict[str, Callable[[], bytes]]
    read: Callable[[Path], object]
    changes: tuple[Change, ...]
    beside: Callable[[Path], None] = lambda folder: None
    share: float = 1.0


def beside_map(folder: Path) -> None:
    """Write the map and all that files about it name."""
    for name in ("", "maps/site", "site/map"):
        (folder / name).mkdir(parents=True, exist_ok=True)
        (folder / name / "map.yaml").write_bytes(MAP)
        (folder / name / "site.pgm").write_bytes(picture("PPM", "L"))
    (folder / "walls.dat").write_bytes(WALLS)
    (folder / "shelf.model.yaml").write_bytes(MODEL)
    (folder / "m.cc").write_bytes(SOURCE)
    (folder / "picture.yaml").write_bytes(MAP)


def read_map(path: Path) -> object:
    """Read a map, and look at it."""
    from arena_worlds.formats.ros_map import load_map

    return load_map(path).occupied.sum()


def read_scenario(path: Path) -> object:
    """Read a scenario file, and try its problems in the room."""
    from arena_core.testing import robot
    from arena_tasks.scenario_files.feasibility import Feasibility
    from arena_tasks.scenario_files.problem import PersonDefaults, reading_notes
    from arena_tasks.scenario_files.scenario_file import read_scenario_file
    from arena_tasks.scenario_files.scenario_task import reason_against

    file = read_scenario_file(path, PersonDefaults(0.3, 0.3))
    reading_notes(file.problems)
    world = World("room", room())
    return [
        reason_against(Feasibility(path, problem, robot(), problem.goal_radius or 0.3), world)
        for problem in file.problems[:3]
    ]


def read_recording_of(path: Path) -> object:
    """Read a recording in the format that its name tells, and sample it."""
    from arena_crowds.replay.recordings import read_recording

    layout: Any = path.name.split(".")[0]
    recording = read_recording(path, layout, None, None)
    return recording.at(np.zeros(3, np.int64), np.linspace(0.0, recording.duration, 3))


def read_policy(path: Path) -> object:
    """Read a policy with its card."""
    from arena_policies.policy import load_policy

    return load_policy(str(path.with_suffix(".onnx")), "rosnav", body())


@cache
def body() -> Any:
    """Return the TurtleBot3."""
    from arena_core.testing import component

    return component("robot", "turtlebot3")


def policy_file(package: str, name: str) -> Callable[[], bytes]:
    """Return what reads a file that a package brings."""
    from importlib.resources import files

    return lambda: files(package).joinpath("policies", name).read_bytes()


def beside_policy(folder: Path) -> None:
    """Write a policy and its card."""
    for name in ("turtlebot3.onnx", "turtlebot3.json"):
        (folder / name).write_bytes(policy_file("arena_rosnav", name)())


def beside_part(folder: Path) -> None:
    """Write a part of a world model and its card."""
    for name in ("turtlebot3.vision.onnx", "turtlebot3.vision.json"):
        (folder / name).write_bytes(policy_file("arena_navrep", name)())


def read_part(path: Path) -> object:
    """Read a part of a world model."""
    from arena_navrep.world_model import load_part

    return load_part(str(path.with_suffix(".onnx")), "vision")


@cache
def run_files() -> dict[str, bytes]:
    """Return the files of a run of three episodes, by their names."""
    import tempfile

    from arena_core.runs.jobs.rows import evaluate_folder, write_episodes
    from arena_core.testing import record

    columns = dict.fromkeys(
        (
            "config_hash",
            "planner",
            "preset",
            "robot",
            "simulator",
            "world",
            "task",
            "scenario_hash",
            "pedestrian_model",
            "reaction",
        ),
        "a",
    )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        world = {"grid": write_grid(folder, room()), "name": "room", "free_area": 14.0}
        for episode, contact in enumerate((False, True, False)):
            made = record(steps=12, contact=contact)
            own = {
                **columns,
                "localizer": "a",
                "timing": "ideal",
                **made.meta["columns"],
                "episode": episode,
                "stage": None,
            }
            meta = {**made.meta, "columns": own, "world": world}
            write_record(folder, episode, type(made)(made.arrays, meta, made.timing))
        write_episodes(folder, evaluate_folder(folder, packs()), packs())
        facts = {
            "config_hash": "a",
            "seed": 0,
            "config": {"seed": 0, "metrics": {"si": metrics_config()["si"]}},
            "versions": {"arena": "1"},
        }
        (folder / "provenance.json").write_text(json.dumps(facts))
        return {
            str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()
        }


@cache
def metrics_config() -> dict[str, Any]:
    """Return the configuration of all packs of metrics."""
    from arena_core.hosting import compose, to_plain

    return dict(to_plain(compose(["metrics=[si,paper_legacy,barn]"], "component"))["metrics"])


@cache
def packs() -> Any:
    """Return all packs of metrics."""
    from arena_core.hosting import load_registry
    from arena_core.records import build_metrics

    return build_metrics({"metrics": metrics_config()}, load_registry())


def beside_run(folder: Path) -> None:
    """Write a whole run."""
    for name, content in run_files().items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


def beside_named_run(folder: Path) -> None:
    """Write a whole run into a folder of its own."""
    beside_run(folder / "run")


def run_file(name: str) -> Callable[[], bytes]:
    """Return what gives a file of that run."""
    return lambda: next(content for key, content in run_files().items() if key.startswith(name))


def read_record_file(path: Path) -> object:
    """Read a record and compute every metric of it."""
    from arena_core.runs.jobs.rows import evaluate_file

    return evaluate_file(path, packs())


def replay_record(path: Path) -> object:
    """Make the replay of a record, and its strip."""
    from arena_viewer.command import ReplayCommand

    run, to = path.parent.parent, path.parent.parent.parent
    return [
        ReplayCommand().run([str(run), "1", f"--to={to / name}"]) for name in (f"{path.stem}.html", f"{path.stem}.png")
    ]


def export_record(path: Path) -> object:
    """Write a record to a recording."""
    from arena_ros.bags.exporting import export_run

    return export_run(path.parent.parent, path.parent / "out.mcap", [1])


def evaluate_run(path: Path) -> object:
    """Compute the metrics of a run again."""
    from arena_core.hosting import load_registry
    from arena_core.runs.folders.resuming import re_evaluate

    folder = (
        path
        if (path / "records").is_dir()
        else path.parent
        if (path.parent / "records").is_dir()
        else path.parent.parent
    )
    return re_evaluate(folder, load_registry())


def report_run(path: Path) -> object:
    """Read a run as a report does, up to its figures."""
    from arena_metrics.pooling.cells import cells_of
    from arena_metrics.pooling.runs import metric_columns, pool_episodes, read_runs
    from arena_metrics.pooling.summary import summarise_cells, summary_csv

    folder = path.parent
    runs = read_runs([folder])
    episodes, _ = pool_episodes(runs)
    return summary_csv(summarise_cells(cells_of(episodes), metric_columns(runs)))


def read_map_of_run(path: Path) -> object:
    """Read the map of a run."""
    from arena_core.records import read_grid

    return read_grid(path)


def build_configuration(path: Path) -> object:
    """Build all components of a configuration."""
    from arena_core.files import read_json
    from arena_core.hosting import build_benchmark, load_registry

    return build_benchmark(read_json(path, "a configuration"), load_registry())


@cache
def configuration(*words: str) -> bytes:
    """Return a whole configuration as JSON."""
    from arena_core.hosting import compose, to_plain

    return json.dumps({**to_plain(compose(["world=empty", *words])), "choices": {}}).encode()


def compose_own(path: Path) -> object:
    """Compose with a preset of one's own."""
    import contextlib

    from arena_core.hosting import compose, to_plain

    with contextlib.chdir(path.parent.parent.parent):
        return to_plain(compose(["planner=mine"]))


def lazily(module: str, name: str, *arguments: Any, **named: Any) -> Callable[[Path], object]:
    """Return what calls a function of a module that is imported only then."""

    def call(path: Path) -> object:
        import importlib

        return getattr(importlib.import_module(module), name)(path, *arguments, **named)

    return call


def import_bag(path: Path) -> object:
    """Import a recording, and compute the metrics of what came of it."""
    from arena_ros.bags.importing import Request, import_bags, reading_of

    request = Request({}, "jackal", "recorded", None, False, reading_of(0.1, 0.3, 180.0, 0.3, ""))
    return import_bags([path], path.parent / f"{path.name}.out", request)


@cache
def laboratory(name: str) -> bytes:
    """Return a recording of two seconds of a drive past people, of the kind that its
    name tells, without compression.
    """
    import tempfile

    from arena_ros.testing.recordings import write_laboratory

    with tempfile.TemporaryDirectory() as folder:
        path = write_laboratory(Path(folder, name), 2.0)
        return (unpacked_bag(path) if path.suffix == ".bag" else path).read_bytes()


def unpacked_bag(path: Path) -> Path:
    """Return a copy of a ROS 1 bag whose messages stand in it as they are."""
    from rosbags.rosbag1 import Reader as BagReader
    from rosbags.rosbag1 import Writer

    copy = path.with_name("unpacked.bag")
    with BagReader(path) as bag, Writer(copy) as writer:
        to = {
            each.id: writer.add_connection(each.topic, each.msgtype, msgdef=each.msgdef.data, md5sum=each.digest)
            for each in bag.connections
        }
        for connection, stamp, content in bag.messages():
            writer.write(to[connection.id], stamp, content)
    return copy


OWN_MODEL = b"""<mujoco model="m"><size nuserdata="3"/><asset><hfield name="h" nrow="4" ncol="4" size="1 1 1 1"/>
</asset><worldbody><body name="a"><freejoint/><geom size="1"/>
<replicate count="4" offset="0 0 1"><geom size=".1"/></replicate></body></worldbody></mujoco>"""
SITE = lazily("arena_worlds.formats.site_file", "site_grid", 0.1, 0.5)
PICTURES = {
    "site.pgm": ("PPM", "L"),
    "site.png": ("PNG", "RGBA"),
    "p.png": ("PNG", "P"),
    "i.png": ("PNG", "I;16"),
    "site.bmp": ("BMP", "RGB"),
    "site.jpg": ("JPEG", "L"),
    "site.gif": ("GIF", "P"),
    "site.tiff": ("TIFF", "L"),
    "site.webp": ("WEBP", "RGB"),
}
READERS: dict[str, Reader] = {
    "map_yaml": Reader({"map.yaml": const(MAP)}, read_map, (TEXT, YAML, BYTES), beside_map),
    "map_image": Reader(
        {name: lambda kind=kind: picture(*kind) for name, kind in PICTURES.items()}, SITE, (BYTES,), share=2.0
    ),
    "flatland_world": Reader({"map.world.yaml": const(FLATLAND_WORLD)}, read_map, (TEXT, YAML), beside_map),
    "line_yaml": Reader({"lines.yaml": const(LINES)}, read_map, (TEXT, YAML), beside_map),
    "line_walls": Reader({"walls.dat": const(WALLS)}, lambda path: lines_of(path), (TEXT, BYTES), beside_map),
    "gazebo": Reader(
        {"w.sdf": gazebo, "w.world.gz": lambda: gzip.compress(gazebo())}, SITE, (XML, TEXT, BYTES), share=1.5
    ),
    "mujoco": Reader({"w.xml": const(MJCF)}, SITE, (XML, TEXT, BYTES)),
    "dynabarn": Reader(
        {"w.world": const(DYNABARN)},
        lambda path: lazily("arena_worlds.generators.dynabarn", "read_dynabarn", path.parent)(path),
        (XML, TEXT),
        beside_map,
    ),
    "animation": Reader(
        {"m.cc": const(SOURCE)}, lazily("arena_worlds.formats.animation", "read_animation"), (TEXT, BYTES)
    ),
    "barn_path": Reader(
        {"path_0.npy": npy(np.arange(8).reshape(4, 2))},
        lazily("arena_worlds.formats.barn", "read_reference_path"),
        (BYTES, TEXT),
    ),
    "map_of_scenario": Reader(
        {"s.json": dumped(TOOLS), "r.json": dumped(ROSNAV), "o.json": dumped(OURS)},
        lambda path: lazily("arena_worlds.formats.scenario_map", "find_map", None)(path),
        (JSON, TEXT),
        beside_map,
    ),
    "scenario_ours": Reader({"s.json": dumped(OURS)}, read_scenario, (JSON, TEXT, BYTES), beside_map, 1.5),
    "scenario_arena_tools": Reader({"s.json": dumped(TOOLS)}, read_scenario, (JSON, TEXT), beside_map),
    "scenario_arena_rosnav": Reader({"s.json": dumped(ROSNAV)}, read_scenario, (JSON, TEXT), beside_map),
    "scenario_flatland": Reader(
        {"s.json": dumped({"scenarios": [SCENE, SCENE]})}, read_scenario, (JSON, TEXT), beside_map
    ),
    "flatland_model": Reader(
        {"shelf.model.yaml": const(MODEL)},
        lambda path: read_scenario(written(path.parent / "s.json", dumped(TOOLS)())),
        (TEXT, YAML),
        beside_map,
    ),
    "pack": Reader(
        {"pack.yaml": dumped(PACK)},
        lambda path: lazily("arena_tasks.scenario_files.pack", "verified_pack")(path.parent),
        (YAML, TEXT),
        beside_map,
    ),
    "curriculum": Reader(
        {"c.yaml": const(CURRICULUM)},
        lambda path: lazily("arena_tasks.random.curriculum", "read_curriculum")(str(path)),
        (TEXT, YAML),
    ),  # type: ignore[arg-type]
    "recording": Reader(
        {
            **{name: const(content) for name, content in TRACKS.items()},
            "frames.txt.gz": lambda: gzip.compress(TRACKS["frames.txt"]),
        },
        read_recording_of,
        (TEXT, BYTES),
        share=1.5,
    ),
    "policy_card": Reader(
        {"turtlebot3.json": policy_file("arena_rosnav", "turtlebot3.json")},
        read_policy,
        (JSON, TEXT),
        beside_policy,
        0.3,
    ),
    "policy_network": Reader(
        {"turtlebot3.onnx": policy_file("arena_rosnav", "turtlebot3.onnx")}, read_policy, (BYTES,), beside_policy, 0.1
    ),
    "part_card": Reader(
        {"turtlebot3.vision.json": policy_file("arena_navrep", "turtlebot3.vision.json")},
        read_part,
        (JSON, TEXT),
        beside_part,
        0.3,
    ),
    "rollouts": Reader(
        {"rollouts/train_00.npz": rollouts},
        lambda path: lazily("arena_navrep.rollouts", "read_rollouts", "train", 1)(path.parent.parent),
        (NPZ, BYTES),
    ),
    "training": Reader(
        {"config.json": dumped({"seed": 0})},
        lambda path: lazily("arena_gym.training.folder", "open_folder", {"seed": 0}, resume=True)(path.parent),
        (JSON, TEXT),
    ),
    "record": Reader({"records/0001.npz": run_file("records/0001")}, read_record_file, (NPZ, BYTES), beside_run, 1.5),
    "record_replayed": Reader(
        {"run/records/0001.npz": run_file("records/0001")}, replay_record, (NPZ,), beside_named_run, 0.05
    ),
    "record_exported": Reader(
        {"run/records/0001.npz": run_file("records/0001")}, export_record, (NPZ,), beside_named_run, 0.1
    ),
    "timing": Reader(
        {"timing/0001.npz": run_file("timing/0001")},
        lambda path: read_record(path.parent.parent / "records/0001.npz"),
        (NPZ, BYTES),
        beside_run,
    ),
    "map_of_run": Reader({"worlds/a.npz": run_file("worlds/")}, read_map_of_run, (NPZ, BYTES)),
    "table": Reader({"episodes.csv": run_file("episodes.csv")}, report_run, (TABLE, TEXT), beside_run, 0.2),
    "table_evaluated": Reader({"episodes.csv": run_file("episodes.csv")}, evaluate_run, (TABLE, TEXT), beside_run, 0.2),
    "provenance": Reader({"provenance.json": run_file("provenance.json")}, report_run, (JSON, TEXT), beside_run, 0.1),
    "provenance_evaluated": Reader(
        {"provenance.json": run_file("provenance.json")}, evaluate_run, (JSON, TEXT), beside_run, 0.2
    ),
    "configuration": Reader({"c.json": configuration}, build_configuration, (JSON,), share=0.3),
    "configuration_staged": Reader(
        {"c.json": lambda: configuration("task=staged", "planner=teb", "world=indoor")},
        build_configuration,
        (JSON,),
        share=0.05,
    ),
    "bag": Reader(
        {"a.mcap": lambda: laboratory("a.mcap"), "a.bag": lambda: laboratory("a.bag")},
        import_bag,
        (NUMBERS, BYTES),
        share=0.1,
    ),
    "bag_data_base": Reader({"a.db3": lambda: laboratory("a")}, import_bag, (DATA_BASE, NUMBERS, BYTES), share=0.1),
    "own_model": Reader(
        {"own.xml": const(OWN_MODEL)}, lazily("arena_mujoco.model_file", "check_model_file"), (XML, TEXT, BYTES)
    ),
    "preset": Reader(
        {"conf/planner/mine.yaml": const(b"name: dwa\nspeed: 1.0\ncontrol_period: null\n")},
        compose_own,
        (TEXT, YAML),
        share=0.01,
    ),
}


def lines_of(path: Path) -> object:
    """Read the walls of a layer."""
    (path.parent / "lines.yaml").write_bytes(LINES)
    return read_map(path.parent / "lines.yaml")


def written(path: Path, content: bytes) -> Path:
    """Write a file and return its path."""
    path.write_bytes(content)
    return path
