"""The worlds of DynaBARN (Nair et al. 2022): a field with three walls, crossed by cylinders whose motions are given."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from arena_core import ConfigurationError, InputFileError, PedestrianSpec, Pose, World, WorldSource, random_generator
from arena_core.files import LIMITS, is_file, read_bytes
from arena_core.parameters import NonNegative, NonNegativeInt, Positive, PositiveInt
from arena_worlds.formats.animation import Animation, read_animation
from arena_worlds.formats.barn import world_files
from arena_worlds.formats.sdf import ALLOWED, models_of, read_lengths, solids_of_models
from arena_worlds.formats.sdf_state import state_of
from arena_worlds.formats.solids import Solids, grid_of
from arena_worlds.formats.xml_file import parse_xml, quote_text
from arena_worlds.generators.motions import Level, Square, draw_animation

HALF = 10.0  # m: the field, a square about the origin
# m: x, y, length, width; open towards +x
WALLS = ((-HALF, 0.0, 0.5, 20.0), (0.0, HALF, 20.0, 0.5), (0.0, -HALF, 20.0, 0.5))
BROKEN, MENDED = b"<pose frame=>", b'<pose frame="">'  # what the published files have, and how Gazebo's parser takes it


@dataclass(frozen=True, slots=True, eq=False)
class Mover:
    """A cylinder, and how it moves; ``radius`` m."""

    name: str
    radius: float
    animation: Animation


@dataclass(frozen=True, slots=True, eq=False)
class MovingField:
    """One world: what stands, and what moves."""

    walls: Solids
    movers: tuple[Mover, ...]


class DynabarnWorlds(WorldSource):
    """World ``index`` of ``path``'s files, or of the set that is drawn, modulo their number; the same for every seed.

    ``path`` is a file or a folder, ``plugins`` the folder of the sources NAME.cc of the plugins that move its models.
    Without a path set number ``draw`` has ``worlds_per_level`` worlds of each level, easy ones first, with cylinders of
    ``radius`` m.
    """

    def __init__(
        self,
        path: str | None,
        plugins: str | None,
        draw: NonNegativeInt,
        worlds_per_level: PositiveInt,
        radius: Positive,
        least_way: Positive,
        spacing: Positive,
        easy: Level,
        medium: Level,
        hard: Level,
        resolution: Positive,
        margin: NonNegative,
        *,
        known: bool,
    ) -> None:
        self._resolution, self._margin, self._known = resolution, margin, known
        if path is None:
            levels = [("easy", easy), ("medium", medium), ("hard", hard)]
            _check_levels(levels)
            square = Square(HALF, least_way, spacing)
            self._fields = tuple(
                _draw_field(draw, number, name, level, radius, square)
                for number, (name, level) in enumerate(each for each in levels for _ in range(worlds_per_level))
            )
            self.names = tuple(f"world_{number}" for number in range(len(self._fields)))
        else:
            files = world_files(Path(path))
            folder = _plugins_folder(files[0], plugins)
            self._fields = tuple(read_dynabarn(file, folder) for file in files)
            self.names = tuple(file.name.split(".")[0] for file in files)

    @property
    def fields(self) -> tuple[MovingField, ...]:
        """Return all worlds as they are written to files."""
        return self._fields

    def world(self, seed: int, index: int) -> World:
        """Return the world of scenario ``index``, the same for every seed, with its movers."""
        number = index % len(self._fields)
        field = self._fields[number]
        grid = grid_of(field.walls, self._resolution, self._margin)
        movers = tuple(_pedestrian_spec(number, mover) for number, mover in enumerate(field.movers))
        return World(f"dynabarn/{self.names[number]}", grid, self._known, movers=movers)


def read_dynabarn(path: Path, plugins: Path | None) -> MovingField:
    """Read a Gazebo world whose models with a plugin move as the plugin's source says; raise InputFileError."""
    root = parse_xml(path, read_bytes(path, LIMITS.xml_bytes, ALLOWED).replace(BROKEN, MENDED), ALLOWED)
    models = models_of(path, root)
    moved = [model for model in models if model.find("plugin") is not None]
    if not moved:
        raise InputFileError(
            f"{path}: no model has a plugin; allowed: DynaBARN's worlds (those of BARN are world=barn)"
        )
    movers = tuple(_read_mover(path, model, plugins) for model in moved)
    return MovingField(
        solids_of_models(path, [model for model in models if model not in moved], state_of(path, root)), movers
    )


def _read_mover(path: Path, model: ElementTree.Element, plugins: Path | None) -> Mover:
    name = model.get("name", "")
    collisions = model.findall("link/collision")
    if len(collisions) != 1 or collisions[0].find("geometry/cylinder") is None:
        raise InputFileError(
            f"{path}: model {name!r} moves and has {len(collisions)} collision shapes; allowed: one, a cylinder"
        )
    radius = read_lengths(path, name, collisions[0], "cylinder/radius", 1)[0]
    library = model.find("plugin").get("filename") or ""  # type: ignore[union-attr]
    source = Path(library).with_suffix(".cc").name if library else ""
    if plugins is None or not source or not is_file(plugins / source):
        where = "there is no folder plugins" if plugins is None else f"it is not in {plugins}"
        raise InputFileError(
            f"{path}: model {name!r} is moved by {quote_text(library)}, "
            f"whose source {source} cannot be read ({where}); "
            "allowed: world.plugins=FOLDER of the sources (compiled ones tell nothing)"
        )
    return Mover(name, radius, read_animation(plugins / source))


def _plugins_folder(world: Path, plugins: str | None) -> Path | None:
    if plugins is None:
        beside = world.resolve().parent.parent / "plugins"
        return beside if beside.is_dir() else None
    if not Path(plugins).is_dir():
        raise ConfigurationError(f"world.plugins is {plugins}; allowed: a folder of plugins' sources NAME.cc, or null")
    return Path(plugins)


def _check_levels(levels: list[tuple[str, Level]]) -> None:
    for name, level in levels:
        for key in ("obstacles", "order", "speed", "std"):
            low, high = getattr(level, f"{key}_min"), getattr(level, f"{key}_max")
            if low > high:
                raise ConfigurationError(f"world.{name}.{key}_min is {low:g}; allowed: up to {key}_max, {high:g}")


@lru_cache(maxsize=256)
def _draw_field(draw: int, number: int, name: str, level: Level, radius: float, square: Square) -> MovingField:
    """Return world ``number`` of a set, which depends on nothing but its level's parameters, the set and the number."""
    random = random_generator(draw, f"dynabarn/world_{number}", "world")
    count = int(random.integers(level.obstacles_min, level.obstacles_max + 1))
    movers = tuple(
        Mover(f"{name}obs_{number}_{k}", radius, draw_animation(random, level, square)) for k in range(count)
    )
    x, y, length, width = np.array(WALLS).T
    boxes = np.stack((x, y, np.zeros(len(WALLS)), length, width), axis=1)
    return MovingField(Solids(Pose(0.0, 0.0), None, boxes, np.empty((0, 3))), movers)


def _pedestrian_spec(number: int, mover: Mover) -> PedestrianSpec:
    places, stamps = mover.animation.positions, mover.animation.stamps
    spans = np.diff(stamps)
    speeds = np.hypot(*np.diff(places, axis=0).T)[spans > 0.0] / spans[spans > 0.0]
    return PedestrianSpec(number, places[0], places, float(speeds.max()), mover.radius, stamps=stamps)
