"""``arena new planner NAME``: a ready third-party package with its test and README."""

from __future__ import annotations

import argparse
import keyword
import re
from collections.abc import Sequence
from pathlib import Path
from string import Template
from typing import ClassVar

from arena_core.errors import ConfigurationError
from arena_core.interfaces import Command
from arena_core.recording import write_text_whole

PYPROJECT = Template("""\
[build-system]
requires = ["hatchling"]
build-backend = "hatchling.build"

[project]
name = "$distribution"
version = "0.1.0"
description = "$title: a local planner for the arena suite"
readme = "README.md"
requires-python = ">=3.11"
dependencies = ["arena-core"]

[project.entry-points.arena]
$module = "$module"

[tool.hatch.build.targets.wheel]
packages = ["$module"]
""")

PLANNER = Template('''\
"""$title: a local planner."""

import math

from arena_core import NoValidCommand, Observation, Planner, Positive, Register, Robot, Twist, hookimpl


class $name(Planner):
    """Drive towards the waypoint, slower the nearer something stands ahead."""

    def __init__(self, robot: Robot, speed: Positive | None, gain: Positive, stop_distance: Positive) -> None:
        self.robot = robot
        self.speed = speed or robot.limits.vx_max
        self.gain = gain
        self.stop_distance = stop_distance

    def compute_velocity(self, observation: Observation) -> Twist:
        """Steer by the waypoint's bearing; raise NoValidCommand when something is too near."""
        nearest = float(observation.scan.ranges.min()) - self.robot.footprint.radius
        if nearest < self.stop_distance:
            raise NoValidCommand(f"something is {nearest:.2f} m away")
        target = observation.pose.relative(observation.waypoint)
        bearing = math.atan2(target.y, target.x)
        speed = min(self.speed, self.robot.limits.vx_max, nearest - self.stop_distance)
        return Twist(max(0.0, speed * math.cos(bearing)), 0.0, self.gain * bearing)


@hookimpl
def register_planners(register: Register) -> None:
    """Offer the planner."""
    register("$module", $name)


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "$module.conf"
''')

NUMBERS = Template("""\
name: $module
speed: null         # [m/s] speed on a free way; null: the robot's own maximum
gain: 2.0           # [1/s] turning rate per bearing of the waypoint (choose your own, and say why)
stop_distance: 0.1  # [m] nearest gap at which the robot still drives
""")

TEST = Template("""\
from arena_core import Pose
from arena_core.testing import check, component, observation, planner, robot


def test_keeps_the_contract_of_a_planner():
    assert check("planner", component("planner", "$module", robot=robot()), robot())


def test_turns_left_to_a_waypoint_on_the_left():
    assert planner("$module", robot()).compute_velocity(observation(waypoint=Pose(1.0, 1.0))).wz > 0.0
""")

README = Template("""\
# $distribution

$title, a local planner for the arena suite.

```
pip install -e .
arena check planner=$module
arena run planner=$module robot=turtlebot3 world=warehouse task=random task.pedestrians=5 episodes=15
pytest
```

Its numbers are in `$module/conf/planner/$module.yaml`; the planner and its two hooks in `$module/__init__.py`.
""")


class NewCommand(Command):
    """Write a new plugin package."""

    help: ClassVar[str] = "a ready third-party package: arena new planner NAME [--out DIR]"

    def run(self, arguments: Sequence[str]) -> int:
        """Write the package into a new folder and say what to do next."""
        parser = argparse.ArgumentParser("arena new", description=self.__doc__)
        parser.add_argument("kind", choices=["planner"])
        parser.add_argument("name", help="such as my_planner: letters, digits and underscores")
        parser.add_argument("--out", default=".", help="where the package's folder is made (default: here)")
        given = parser.parse_args(list(arguments))
        folder = write_planner(given.name, Path(given.out))
        print(f"wrote {folder}; next: pip install -e {folder} && arena check planner={given.name}")
        return 0


def write_planner(module: str, parent: Path) -> Path:
    """Write the package of planner ``module`` below ``parent`` and return its folder; never overwrites anything."""
    if not re.fullmatch(r"[a-z][a-z0-9_]*", module) or keyword.iskeyword(module):
        raise ConfigurationError(f"planner name is {module!r}; allowed: a lower-case Python name such as my_planner")
    folder = parent / module.replace("_", "-")
    if folder.exists():
        raise ConfigurationError(f"{folder} exists already; choose another name or --out DIR")
    words = {
        "module": module,
        "distribution": module.replace("_", "-"),
        "title": module.replace("_", " ").capitalize(),
        "name": "".join(part.capitalize() for part in module.split("_")) + ("" if module.endswith("planner") else "Planner"),
    }
    package = folder / module
    content = {
        folder / "pyproject.toml": PYPROJECT,
        folder / "README.md": README,
        package / "__init__.py": PLANNER,
        package / "conf" / "__init__.py": Template(""),
        package / "conf" / "planner" / f"{module}.yaml": NUMBERS,
        folder / "tests" / f"test_{module}.py": TEST,
    }
    for path, template in content.items():
        write_text_whole(path, template.substitute(words))
    return folder
