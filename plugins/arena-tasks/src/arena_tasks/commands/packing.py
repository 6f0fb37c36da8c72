"""``arena scenario pack``: make a folder of maps and scenario files a pack that `scenario=ID/NAME` runs."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import yaml

from arena_core import InputFileError
from arena_core.commands import Command
from arena_core.files import write_text_whole
from arena_tasks.scenario_files.pack import FORMAT, PACK_FILE, Pack, hash_of, read_pack
from arena_tasks.scenario_files.problem import PersonDefaults
from arena_tasks.scenario_files.scenario_file import ScenarioFile, read_scenario_file

PACKED = (".json", ".yaml", ".yml", ".png", ".pgm", ".bmp", ".jpg", ".jpeg")
# what a task would fill in; a pack only asks whether its files can be read
ANYBODY = PersonDefaults(speed=0.3, radius=0.3)


class PackCommand(Command):
    """Write pack.yaml and the Hydra options of a folder's scenario files."""

    help: ClassVar[str] = (
        "make a folder of maps and scenarios a pack, or take changed files over: arena scenario pack DIR"
    )

    def run(self, arguments: Sequence[str]) -> int:
        """Write the files and say what they are."""
        parser = argparse.ArgumentParser("arena scenario pack", description=self.__doc__)
        parser.add_argument("folder", metavar="DIR", type=Path)
        for key, meaning in (
            ("id", "what it is called in scenario=ID/NAME (the folder's name)"),
            ("version", "(1.0.0)"),
        ):
            parser.add_argument(f"--{key}", help=meaning)
        for key, meaning in (("title", "one sentence (the id)"), ("licence", "(none)")):
            parser.add_argument(f"--{key}", help=meaning)
        parser.add_argument(
            "--conf",
            type=Path,
            default=Path("conf"),
            help="where Hydra options are written (conf, which every run reads)",
        )
        parser.add_argument(
            "--address", help="what the options call DIR (DIR as given), such as pkg://my_package/packs/my_pack"
        )
        given = parser.parse_args(list(arguments))
        wanted = {key: value for key in ("id", "version", "title", "licence") if (value := getattr(given, key))}
        pack = make_pack(given.folder, wanted)
        options = write_options(pack, given.conf / "scenario" / pack.id, given.address or given.folder.as_posix())
        print(f"{pack.folder / PACK_FILE}: {pack.id} {pack.version}, {len(pack.files)} files")
        print("\n".join(f"scenario={pack.id}/{name}" for name in options))
        return 0


def make_pack(folder: Path, wanted: dict[str, str]) -> Pack:
    """Write a folder's pack.yaml again, with ``wanted`` in place of what it said; every scenario file must
    be readable and name its map.
    """
    if not folder.is_dir():
        raise InputFileError(f"{folder}: is no folder; allowed: a folder with maps and scenario files")
    name = folder.resolve().name
    before = read_pack(folder) if (folder / PACK_FILE).exists() else Pack(folder, name, "1.0.0", name, "none", {})
    said = {"id": before.id, "version": before.version, "title": before.title, "licence": before.licence, **wanted}
    pack = Pack(folder, **said, files={name: hash_of(folder / name) for name in _files_of(folder)})
    if not pack.scenario_files():
        raise InputFileError(f"{folder}: holds no scenario file; allowed: at least one .json in it or one folder below")
    for name in pack.scenario_files():
        _map_of(pack, name, read_scenario_file(folder / name, ANYBODY))
    content = {"format": FORMAT, **said, "files": pack.files}
    write_text_whole(folder / PACK_FILE, yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=140))
    return read_pack(folder)


def write_options(pack: Pack, target: Path, address: str) -> list[str]:
    """Write a Hydra option for each scenario file and return their names; ``address`` is what
    they call the pack's folder.
    """
    names = []
    for name in pack.scenario_files():
        file = read_scenario_file(pack.folder / name, ANYBODY)
        option = Path(name).stem
        if option in names:
            raise InputFileError(
                f"{pack.folder / name}: is the second scenario file called {option}; allowed: names that differ"
            )
        title, map_file = " ".join((file.title or option).split()), _map_of(pack, name, file)
        write_text_whole(target / f"{option}.yaml", _option_text(title, f"{address}/{map_file}", f"{address}/{name}"))
        names.append(option)
    return names


def _option_text(title: str, map_address: str, scenario_address: str) -> str:
    choices = yaml.safe_dump(
        {"world": {"path": map_address}, "task": {"path": scenario_address}}, sort_keys=False, width=1000
    )
    return (
        f"# @package _global_\n# {title}\ndefaults:\n  - override /world: ros_map\n  - override /task: "
        f"scenario\n\n{choices}"
    )


def _files_of(folder: Path) -> list[str]:
    """Return the packed files in a folder and one below, relative to it, sorted."""
    found = [
        path.relative_to(folder) for pattern in ("*", "*/*") for path in folder.glob(pattern) if path.suffix in PACKED
    ]
    return sorted(path.as_posix() for path in found if path.name != PACK_FILE and not path.name.startswith("."))


def _map_of(pack: Pack, name: str, file: ScenarioFile) -> str:
    """Return the map's YAML file that a scenario file names, relative to the pack."""
    if not file.map:
        raise InputFileError(
            f"{pack.folder / name}: map is missing; allowed: its map's YAML file, relative to this one"
        )
    path = (pack.folder / name).parent / file.map
    relative = (
        path.resolve().relative_to(pack.folder.resolve()).as_posix()
        if path.resolve().is_relative_to(pack.folder.resolve())
        else ""
    )
    if relative not in pack.files:
        raise InputFileError(
            f"{pack.folder / name}: map is {file.map!r}; allowed: a YAML file of this pack, relative to this file"
        )
    return relative
