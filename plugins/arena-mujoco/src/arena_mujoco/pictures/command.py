"""``arena render``: pictures and films of a recorded episode in 3-D."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import yaml
from numpy.typing import NDArray

from arena_core import ConfigurationError, EpisodeRecord, Robot
from arena_core.commands import Command, print_notice, read_words
from arena_core.files import local_path
from arena_core.hosting import load_registry
from arena_core.parameters import NonNegative, NonNegativeInt, Positive, read_settings
from arena_core.records import find_runs, read_grid, read_record, record_path
from arena_drawing.film import check_encoder, check_target, write_film, write_picture
from arena_mujoco.body import UNKNOWN, Body, BodyFigures, body_of
from arena_mujoco.pictures.appearance import Appearance, load_appearance
from arena_mujoco.pictures.rendering import Camera
from arena_mujoco.pictures.scene import SceneModel
from arena_mujoco.pictures.scene_states import SceneStates

USAGE = (
    "arena render RUN [EPISODE] out=FILE.mp4|.gif|.png [camera=follow|top|onboard] [size=640x480] [rate=20] [speed=1] "
    "[from=0] [until=END] [at=MIDDLE] [lidar=true]"
)
KEYS = ("out", "camera", "size", "rate", "speed", "from", "until", "at", "lidar")
LARGEST = (3840, 2160)  # pixels
MOST_GIF_FRAMES = 600  # all of a GIF's frames are held until it is written
Window = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class RenderRequest:
    """What is to be drawn: ``target`` from ``begin`` to ``until`` s (None: the end), or the picture at
    ``at`` s (None: the middle).
    """

    folder: Path
    episode: int
    target: Path
    camera: Camera
    size: tuple[int, int]
    rate: float
    speed: float
    begin: float
    until: float | None
    at: float | None
    lidar: bool


def read_request(arguments: Sequence[str]) -> RenderRequest:
    """Return what the words after ``arena render`` ask for; raise ConfigurationError where they cannot be read."""
    words = read_words(USAGE, arguments, names=None, keys=KEYS)
    if len(words.names) not in (1, 2):
        raise ConfigurationError(f"arguments are {' '.join(words.names) or 'none'}; allowed: {USAGE}")
    target = Path(words.required("out"))
    check_target(target)
    return RenderRequest(
        Path(words.names[0]),
        read_settings(_parse_number(words.names[1]), NonNegativeInt, "EPISODE") if len(words.names) == 2 else 0,
        target,
        words.value("camera", Camera, "follow"),
        _parse_size(words.value("size", str, "640x480")),
        words.value("rate", Positive, 20.0),
        words.value("speed", Positive, 1.0),
        words.value("from", NonNegative, 0.0),
        words.value("until", Positive | None, None),
        words.value("at", NonNegative | None, None),
        words.value("lidar", bool, True),
    )


class RenderCommand(Command):
    """Draw a recorded episode in 3-D, whichever simulator drove it."""

    help: ClassVar[str] = "pictures and films in 3-D: arena render RUN EPISODE out=FILE.mp4|.gif|.png"

    def run(self, arguments: Sequence[str]) -> int:
        """Write the file and say where it is."""
        if not arguments or any(word in ("-h", "--help") for word in arguments):
            print(f"usage: {USAGE}")
            return 0
        request = read_request(arguments)
        check_encoder(request.target)
        folder = _run_folder(request.folder)
        record = read_record(record_path(folder, request.episode))
        drama = SceneStates(record, load_appearance().follow.calm)
        stamps = _frame_stamps(request, drama.end)
        with _EpisodeRenderer(folder, record, drama, request) as paint:
            if request.target.suffix == ".png":
                write_picture(
                    request.target, paint(0.5 * drama.end if request.at is None else min(request.at, drama.end))
                )
            else:
                write_film(request.target, map(paint, stamps), request.size, request.rate)
        print_notice(f"{request.target}")
        return 0


def _frame_stamps(request: RenderRequest, last: float) -> list[float]:
    """Return when a film's frames are, s; raise ConfigurationError where there are
    none, or more than a GIF may have.
    """
    end = last if request.until is None else min(request.until, last)
    count = int((end - request.begin) * request.rate / request.speed) + 1
    if end <= request.begin:
        raise ConfigurationError(
            f"from is {request.begin:g} and until {end:g}; allowed: times before the end of the episode, {last:g} s"
        )
    if request.target.suffix == ".gif" and count > MOST_GIF_FRAMES:
        raise ConfigurationError(
            f"out is {request.target.name} of {count} frames; allowed: {MOST_GIF_FRAMES} (a smaller rate), or .mp4"
        )
    return [request.begin + frame * request.speed / request.rate for frame in range(count)]


class _EpisodeRenderer:
    """Paints moments of a recorded episode; what the driver holds is given back at the end."""

    def __init__(self, folder: Path, record: EpisodeRecord, drama: SceneStates, request: RenderRequest) -> None:
        from arena_mujoco.pictures.rendering import SceneRenderer, SceneView

        name = record.meta["world"].get("grid")
        if name is None:
            raise ConfigurationError(f"{folder}: the episode has no map; allowed: episodes of a known world")
        grid, own = read_grid(folder / name), load_appearance()
        robot = _record_robot(record)
        body = _record_body(record, robot)
        self._drama = drama
        view = SceneView(request.camera, request.size, request.lidar)
        self._painter = SceneRenderer(SceneModel(record, grid, robot, body, own), robot, body, own, view)
        self._window = _camera_window(grid.positions(np.argwhere(~grid.occupied)), own)
        self._title = f"{record.meta['columns']['planner']} on {robot.name}"

    def __enter__(self) -> Callable[[float], NDArray[np.uint8]]:
        return self._render_frame

    def __exit__(self, *error: object) -> None:
        self._painter.close()

    def _render_frame(self, stamp: float) -> NDArray[np.uint8]:
        return self._painter.render(self._drama.at(stamp), f"{self._title}  {stamp:5.1f} s", self._window)


def _camera_window(free: NDArray[np.float64], own: Appearance) -> Window:
    """Return what a camera above is to show: the free cells and a margin."""
    (left, bottom), (right, top) = free.min(axis=0) - own.top.margin, free.max(axis=0) + own.top.margin
    return float(left), float(right), float(bottom), float(top)


def _run_folder(folder: Path) -> Path:
    runs = find_runs(folder)
    if len(runs) != 1:
        raise ConfigurationError(
            f"{folder} holds {len(runs)} runs; allowed: the folder of one{f', such as {runs[0]}' if runs else ''}"
        )
    return runs[0]


def _record_robot(record: EpisodeRecord) -> Robot:
    """Return the robot as the record's configuration says it; raise ConfigurationError where its
    package is not installed.
    """
    config: Mapping[str, Any] = record.meta["config"].get("robot") or {}
    robot: Robot = load_registry().build("robot", config)
    return robot


def _record_body(record: EpisodeRecord, robot: Robot) -> Body:
    """Return the robot's body: of a file if it had one that is still there, else with its maker's figures
    where the package has them.
    """
    driven = (record.meta["config"].get("simulator") or {}).get("body") or {}
    if driven.get("model") is not None and local_path(driven["model"]).is_file():
        return body_of(robot, read_settings(driven, BodyFigures, "body"))
    tuning = files("arena_mujoco.conf") / "simulator" / "mujoco_tuning" / f"{robot.name}.yaml"
    known: Mapping[str, Any] = yaml.safe_load(tuning.read_text())["body"] if tuning.is_file() else {}
    missing = {name: getattr(UNKNOWN, name) for name in UNKNOWN.__slots__ if name not in known}
    return body_of(robot, read_settings({**missing, **known}, BodyFigures, "body"))


def _parse_number(text: str) -> Any:
    return int(text) if text.isdecimal() else text


def _parse_size(text: str) -> tuple[int, int]:
    """Return width and height in pixels, both even, as films need them."""
    width, x, height = text.partition("x")
    if not (x and width.isdecimal() and height.isdecimal()):
        raise ConfigurationError(f"size is {text}; allowed: WIDTHxHEIGHT in pixels, such as 640x480")
    size = int(width), int(height)
    if not all(16 <= side <= most and side % 2 == 0 for side, most in zip(size, LARGEST, strict=True)):
        raise ConfigurationError(f"size is {text}; allowed: even numbers from 16x16 to {LARGEST[0]}x{LARGEST[1]}")
    return size
