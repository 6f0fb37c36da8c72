"""``arena new KIND NAME``: a ready third-party package with its test and README, from the templates of its kind."""

from __future__ import annotations

import argparse
import keyword
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from string import Template
from typing import ClassVar

from arena_core.base.errors import ConfigurationError
from arena_core.base.whole_files import write_text_whole
from arena_core.config.output_word import split_out
from arena_core.contracts.running import Command

FRAME = "frame"  # the folder of what every package has
MODULE = "MODULE"  # in the names of templates: the package's name


@dataclass(frozen=True, slots=True)
class Kind:
    """What can be made: what it is, the configuration group of its option, the end of its class's name,
    what to try, and what it needs.
    """

    noun: str
    group: str
    suffix: str
    run: str
    needs: tuple[str, ...] = ()

    def commands(self, module: str) -> list[str]:
        """Return what to try once the package is installed."""
        checked = [] if self.group == "scenario" else [f"arena check {self.group}={module}"]
        return [*checked, *([f"arena run {self.run.format(module=module)}"] if self.run else [])]


KINDS = {
    "planner": Kind(
        "a local planner", "planner", "Planner", "planner={module} robot=turtlebot3 task.pedestrians=5 episodes=15"
    ),
    "robot": Kind("a robot", "robot", "", "robot={module} planner=dwa episodes=15"),
    "metric": Kind("a pack of metrics", "metrics", "Metrics", "metrics=[si,{module}] episodes=15"),
    "world": Kind("a source of worlds", "world", "World", "world={module} episodes=15"),
    "scenario": Kind(
        "scenarios", "scenario", "", "scenario={module}/crossing episodes=10", ("arena-tasks", "arena-worlds")
    ),
    "task": Kind("a task", "task", "Task", "task={module} episodes=15"),
    "localizer": Kind("a localiser", "localizer", "Localizer", "localizer={module} episodes=15"),
    "predictor": Kind(
        "a predictor of moving obstacles",
        "predictor",
        "Predictor",
        "predictor={module} planner=teb task.pedestrians=10 episodes=15",
    ),
    "communication": Kind(
        "what carries messages between the robots of a team",
        "communication",
        "Radio",
        "communication={module} task=antipodal world=empty planner=orca localizer=ground_truth episodes=5",
    ),
    "encoder": Kind("an observation encoder for learned planners", "observation_encoder", "Encoder", ""),
}


class NewCommand(Command):
    """Write a new plugin package."""

    help: ClassVar[str] = f"a ready third-party package: arena new {'|'.join(KINDS)} NAME [out=DIR]"

    def run(self, arguments: Sequence[str]) -> int:
        """Write the package into a new folder and say what to do next."""
        words, out = split_out(arguments)
        usage = (
            f"arena new {{{','.join(KINDS)}}} NAME [out=DIR]   (DIR: where the package's folder is made, default: here)"
        )
        parser = argparse.ArgumentParser("arena new", usage=usage, description=self.__doc__)
        parser.add_argument("kind", choices=list(KINDS))
        parser.add_argument("name", help="such as my_planner: letters, digits and underscores")
        given = parser.parse_args(words)
        folder = write_package(given.kind, given.name, Path(out or "."))
        print(f"wrote {folder}; next: pip install -e {folder} && {KINDS[given.kind].commands(given.name)[0]}")
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the kinds."""
        return () if words else list(KINDS)


def write_package(kind: str, module: str, parent: Path) -> Path:
    """Write a package that offers one thing called ``module`` below ``parent`` and return its
    folder; never overwrites anything.
    """
    if not re.fullmatch(r"[a-z][a-z0-9_]*", module) or keyword.iskeyword(module):
        raise ConfigurationError(f"{kind} name is {module!r}; allowed: a lower-case Python name such as my_{kind}")
    folder = parent / module.replace("_", "-")
    if folder.exists():
        raise ConfigurationError(f"{folder} exists already; choose another name or out=DIR")
    words = _template_words(KINDS[kind], module)
    templates = files("arena_core") / "templates"
    for source in (FRAME, kind):
        for path, template in _template_files(templates / source):
            content = Template(template.read_text(encoding="utf-8")).substitute(words)
            write_text_whole(folder / path.replace(MODULE, module), content)
    return folder


def _template_words(kind: Kind, module: str) -> dict[str, str]:
    """Return what the templates leave open."""
    name = "".join(part.capitalize() for part in module.split("_"))
    return {
        "module": module,
        "distribution": module.replace("_", "-"),
        "title": module.replace("_", " ").capitalize(),
        "name": name + ("" if name.endswith(kind.suffix) else kind.suffix),
        "noun": kind.noun,
        "dependencies": ", ".join(f'"{name}"' for name in ("arena-core", *kind.needs)),
        "commands": "\n".join(kind.commands(module)),
        "option": f"{module}/conf/{kind.group}/" + (f"{module}/" if kind.group == "scenario" else f"{module}.yaml"),
    }


def _template_files(folder: Traversable, place: str = "") -> Iterator[tuple[str, Traversable]]:
    """Yield every template below a folder with the path of the file that it makes."""
    for entry in folder.iterdir():
        if entry.is_dir():
            yield from _template_files(entry, f"{place}{entry.name}/")
        else:
            yield f"{place}{entry.name.removesuffix('.in')}", entry
