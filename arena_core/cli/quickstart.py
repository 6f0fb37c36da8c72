"""``arena quickstart``: a first result, without a question."""

from __future__ import annotations

import webbrowser
from collections.abc import Sequence
from itertools import chain, count
from pathlib import Path
from typing import ClassVar

from arena_core.base.errors import ConfigurationError
from arena_core.base.folders import KEPT
from arena_core.base.notices import print_notice
from arena_core.cli.commands import RunCommand
from arena_core.cli.words import read_words
from arena_core.config.registry import Registry, load_registry
from arena_core.contracts.running import Command
from arena_core.runs.text_columns import align_columns

USAGE = "arena quickstart [out=DIR] [open=true]"
PLANNERS = ("dwa", "orca", "rosnav", "mppi", "teb", "mpc", "pure_pursuit")  # those whose kernels compile soonest, first
COMPARED = 2
PAGE = Path("report", "index.html")
NEXT = (
    ("arena replay {run} 0", "watch an episode"),
    ("arena run -m planner={planners} robot=turtlebot3", "another robot; arena list says what there is"),
    ("arena new planner my_planner", "a planner of your own, ready to run"),
    ('eval "$(arena completion bash)"', "TAB completes commands, options and keys (or zsh)"),
)


class QuickstartCommand(Command):
    """Draw maps, drive two planners on them, and open the page that compares them."""

    help: ClassVar[str] = "a first result: two planners on maps that are drawn for you"
    kept: ClassVar[str] = KEPT

    def run(self, arguments: Sequence[str]) -> int:
        """Run the experiment ``quickstart`` in a folder of its own; return the exit status of the run."""
        if {"-h", "--help"} & set(arguments):
            print(f"usage: {USAGE}\n\n{self.__doc__}")
            return 0
        words = read_words(USAGE, arguments, keys=("out", "open"))
        opens = words.value("open", bool, True)
        folder = words.value("out", str | None, None) or free_name("quickstart")
        planners = first_planners(load_registry())
        print_notice(f"a Jackal among people on six drawn maps, driven by {' and '.join(planners)}")
        chosen = ["experiment=quickstart", f"planner={','.join(planners)}"]
        status = RunCommand().run(["-m", *chosen, f"out={folder}"])
        page = Path(folder) / PAGE
        rows = [(f"  {line}".format(run=Path(folder) / "0", planners=",".join(planners)), why) for line, why in NEXT]
        print("\n".join(["what next:", *align_columns(rows)]))
        if opens and page.is_file():
            webbrowser.open(page.absolute().as_uri())
        return status


def first_planners(registry: Registry) -> Sequence[str]:
    """Return the planners to compare, of those that are installed; raise ConfigurationError where none is."""
    known = registry.names("planner")
    found = [name for name in PLANNERS if name in known][:COMPARED]
    if not found:
        packages = ", ".join(f"arena-{name.replace('_', '-')}" for name in PLANNERS)
        raise ConfigurationError(f"no planner is installed; allowed: one of {packages}")
    return found


def free_name(name: str) -> str:
    """Return a name that nothing has here: ``name``, ``name-2``, ..."""
    names = chain([name], (f"{name}-{number}" for number in count(2)))
    return next(found for found in names if not Path(found).exists())
