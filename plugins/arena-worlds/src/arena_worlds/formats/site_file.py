"""A world in a file of any format, which the file's ending tells: read as a grid or as solids, and written."""

from __future__ import annotations

from pathlib import Path

from arena_core import ConfigurationError, InputFileError, OccupancyGrid, World
from arena_core.files import write_text_whole
from arena_core.scenes import scene_of
from arena_worlds.formats.map_writer import write_map
from arena_worlds.formats.mjcf import read_mjcf
from arena_worlds.formats.mjcf_writer import mjcf_text
from arena_worlds.formats.picture import read_picture, write_picture
from arena_worlds.formats.ros_map import load_map
from arena_worlds.formats.sdf import read_sdf
from arena_worlds.formats.sdf_writer import sdf_text
from arena_worlds.formats.solids import Solids, grid_of, solids_of

ROS, PICTURE, GAZEBO, MUJOCO = (".yaml", ".yml"), (".png", ".pgm"), (".sdf", ".world"), (".xml",)
PICTURES_READ = (*PICTURE, ".bmp", ".jpg", ".jpeg", ".gif", ".tif", ".tiff", ".webp")


def read_site(path: Path, resolution: float) -> OccupancyGrid | Solids:
    """Read a world; a picture's cells measure ``resolution`` m.

    Raises InputFileError, also for an ending that no format has.
    """
    ending = Path(path.stem).suffix if path.suffix == ".gz" else path.suffix
    if ending in ROS or path.is_dir():
        return load_map(path)
    if path.suffix in PICTURES_READ:
        return read_picture(path, resolution)
    if ending in GAZEBO:
        return read_sdf(path)
    if ending in MUJOCO:
        return read_mjcf(path)
    endings = ", ".join((*ROS, *PICTURES_READ, *GAZEBO, *MUJOCO))
    raise InputFileError(
        f"{path}: ends in {path.suffix!r}; allowed: a folder with a map, "
        f"or a file that ends in {endings} (or .world.gz)"
    )


def site_grid(path: Path, resolution: float, margin: float) -> OccupancyGrid:
    """Read a world as a grid; solids on cells of ``resolution`` m, with ``margin`` m around them
    where no ground bounds them.
    """
    site = read_site(path, resolution)
    return grid_of(site, resolution, margin) if isinstance(site, Solids) else site


def check_ending(path: Path) -> None:
    """Raise ConfigurationError for a file that ``write_site`` cannot write."""
    if path.suffix not in (".yaml", *PICTURE, *GAZEBO, *MUJOCO):
        endings = ", ".join((".yaml", *PICTURE, *GAZEBO, *MUJOCO))
        raise ConfigurationError(f"{path}: ends in {path.suffix!r}; allowed: a file that ends in {endings}")


def write_world(path: Path, world: World, height: float) -> None:
    """Write a world, its walls ``height`` m high and its furniture as it stands, as
    a Gazebo world or a MuJoCo model.
    """
    text = sdf_text if path.suffix in GAZEBO else mjcf_text
    write_text_whole(path, text(scene_of(world.grid, (), height, world.furniture), path.stem))


def write_site(path: Path, site: OccupancyGrid | Solids, resolution: float, margin: float, height: float) -> list[Path]:
    """Write a world, its walls ``height`` m high, and return the files; solids become a grid as ``site_grid`` says."""
    check_ending(path)
    if path.suffix in (*GAZEBO, *MUJOCO):
        solids = site if isinstance(site, Solids) else solids_of(site)
        text = sdf_text if path.suffix in GAZEBO else mjcf_text
        write_text_whole(path, text(solids.raised(height), path.stem))
        return [path]
    grid = grid_of(site, resolution, margin) if isinstance(site, Solids) else site
    if path.suffix == ".yaml":
        return write_map(path, grid)
    write_picture(path, grid)
    return [path]
