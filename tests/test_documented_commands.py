"""Every command of the documentation: quick ones are run as they stand, block by block; what
drives, trains or measures is composed.
"""

import json
import os
import re
import shlex
import shutil
import subprocess
import tomllib
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest
from PIL import Image

from arena_aio.choices_command import USAGE as CHOICES
from arena_break.command import ACTIONS
from arena_break.command import KEYS as BREAK_KEYS
from arena_core import run as run_benchmark
from arena_core.commands import split_out
from arena_core.config.configuration import compose
from arena_core.config.option_folders import option_files, own_folder
from arena_core.config.plugins import load_plugins
from arena_core.hosting import load_registry
from arena_crowds.validation.command import EXPERIMENTS
from arena_crowds.validation.measure import read_request
from arena_ladder.command import KEYS as LADDER_KEYS
from arena_mujoco.pictures.command import read_request as read_picture
from arena_navrep.navrep_command import STAGES
from arena_prediction.predict_command import STAGES as FORESIGHT_STAGES
from arena_ros.bags.topic_roles import all_roles
from arena_ros.commands import IMPORT_KEYS, USAGES
from arena_ros.live.commands import DRIVE_KEYS, SIMULATE_KEYS
from arena_ros.live.controller import KEYS as CONTROLLER_KEYS
from arena_studio.command import read_request as read_studio
from arena_tuning.command import read_request as read_tuning
from arena_tuning.driving import compose_cells
from arena_viewer.command import read_request as read_replay

TOP = Path(__file__).resolve().parents[1]
DRAWN = TOP / "tests" / "data"
PAGES = sorted([*TOP.glob("*.md"), *(TOP / "docs").rglob("*.md"), *TOP.glob("plugins/*/README.md")])
FIRST = r"(?:(?:arena|make|pip|python|git|for|\.) |scripts/|[A-Z_]+=\S+ (?:make|arena) )"
USAGE = re.compile(r"\[-m\]|\[\w+=|DIR\.\.\.|KEY=VALUE|\bNAME\b|  +")  # words of a synopsis
SOUGHT = re.compile(r"\w+\(")  # a range of which a sweeper tries some values
COUNTED = re.compile(r"(episodes|seed|task\.pedestrians)=\d+")  # any number does
OWN = re.compile(r"\bmy_\w+|\bmine\b")  # what a reader has made
COMMANDS = set(load_registry().names("command"))


@dataclass(frozen=True)
class Block:
    """The commands of one block of a page, each with the line that follows it."""

    page: str
    commands: tuple[tuple[str, str], ...]

    @property
    def name(self):
        return f"{self.page}: {self.commands[0][0][:50]}"


def blocks():
    for path in PAGES:
        for language, text in re.findall(r"^```(\w*)\n(.*?)^```$", path.read_text(), re.M | re.S):
            lines = [re.sub(r"(^|\s+)#.*$", "", line).strip() for line in re.sub(r"\s*\\\n\s*", " ", text).splitlines()]
            bare = [line.removeprefix("$ ") for line in lines] + [""]
            found = [
                (line, after)
                for line, after in pairwise(bare)
                if re.match(FIRST + r"(?!\s)", line) and not USAGE.search(line)
            ]
            if found and not language:
                yield Block(str(path.relative_to(TOP)), tuple(found))


BLOCKS = list(blocks())


def values(word):
    """Return key and values of KEY=A,B; a bracketed list and a range are one value."""
    key, value = word.split("=", 1)
    return key, [value] if re.match(r"[\[{\"]|\w+\(", value) else value.split(",")


def composed(words, primary="config"):
    """Compose with the first of each list of values; the others have to be options of their group."""
    first, groups = [], load_plugins()
    for word in words:
        if "=" not in word:
            assert word in ("-m", "--multirun"), word
            continue
        key, offered = values(word)
        offered = [value for value in offered if not OWN.fullmatch(value) and not SOUGHT.match(value)]
        first += [f"{key}={offered[0]}"] if offered else []
        if re.fullmatch(r"\w+", key) and len(offered) > 1:
            options = set(option_files(key, groups))
            assert set(offered) <= options or not options, word
    compose_once(tuple(COUNTED.sub(r"\1=1", word) for word in first), primary, own_folder())


@cache
def compose_once(words, primary, own):
    """Compose what pages say alike once for all of them, unless there is a folder of one's own."""
    compose(words, primary)


@cache
def make_once(words):
    subprocess.run(["make", "--dry-run", *words], cwd=TOP, check=True, capture_output=True)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Return the folder of one short run."""
    folder = tmp_path_factory.mktemp("finished") / "run"
    words = (
        "planner=pure_pursuit world=empty world.width=6 world.height=6 task.pedestrians=0 episodes=2 executor=serial"
    )
    run_benchmark(words.split(), folder)
    return folder


@pytest.fixture
def shell(arena, third_party, finished, monkeypatch):
    """Return what runs or validates a command, in a folder with what the documentation's reader
    has: maps, scenarios, a pack, runs.
    """
    copies = {
        "maps/hall/map.yaml": ("site.yaml", "map.yaml", "maps/hall/map.yaml", "maps/small_warehouse/map.yaml"),
        "maps/hall/map.pgm": ("map.pgm", "maps/hall/map.pgm", "maps/small_warehouse/map.pgm"),
        "scenarios/hall_obs03.json": ("scenario.json", "small_warehouse_obs05.json", "map5_obs05.json"),
    }
    for source, targets in copies.items():
        for target in targets:
            Path(target).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(DRAWN / source, target)
    write_packs()
    Path("mine.yaml").write_text(
        re.search(r"```yaml\n(source.*?)```", (TOP / "docs" / "claims.md").read_text(), re.S)[1]
    )
    for name in (
        "outputs/2026-01-31/12-00-00",
        "outputs/lab",
        "multirun/teb",
        "multirun/dwa",
        "multirun/aio",
        "multirun/paper",
    ):
        shutil.copytree(finished, name)
    return Shell(arena, third_party)


def write_packs():
    """Write two packs, a scenario of arena-rosnav and a file with an impossible problem, from the drawn ones."""
    problem = {"name": "monday", "start": [1.0, 4.0], "goal": [11.0, 4.0]}
    for pack in ("my_pack", "src/my_scenarios/my_pack"):
        for folder in ("maps", "scenarios"):
            Path(pack, folder).mkdir(parents=True)
        Image.open("map.pgm").save(Path(pack, "maps", "lab.png"))
        Path(pack, "maps", "lab.yaml").write_text(Path("map.yaml").read_text().replace("map.pgm", "lab.png"))
        content = {"format": "arena-scenario", "version": 2, "map": "../maps/lab.yaml", "scenarios": [problem]}
        Path(pack, "scenarios", "monday.json").write_text(json.dumps(content))
    impossible = {**problem, "name": "corner", "start": [-1.0, -1.0]}
    Path("scenes.json").write_text(
        json.dumps({"format": "arena-scenario", "version": 2, "scenarios": [problem, impossible]})
    )
    world = Path("worlds/small_warehouse/scenarios/default.json")
    world.parent.mkdir(parents=True)
    world.write_text(
        json.dumps({"robots": [{"start": [1.0, 4.0], "goal": [11.0, 4.0]}], "obstacles": {"static": [], "dynamic": []}})
    )


def first_cell(sets, words, place):
    return compose_cells(replace(sets, cells=sets.cells[:1]), words, place)


class Shell:
    """Runs what is quick and validates what is not; whatever it does not know fails."""

    def __init__(self, arena, third_party):
        self.arena, self.third_party = arena, third_party

    def __call__(self, line, after):
        if after.startswith("arena: "):
            return self.refused(line, after)
        words = shlex.split(line)
        while "=" in words[0]:  # VARIABLE=VALUE before a command
            words.pop(0)
        kind = words[0] if words[0] != "arena" else f"arena {words[1]}"
        known = {
            **{
                "arena run": self.composed,
                "arena train": self.train,
                "arena navrep": self.navrep,
                "arena predict": self.predict,
                "arena choices": self.composed,
                "arena tune": self.tune,
                "arena quickstart": self.quickstart,
            },
            "arena profile": self.profile,
            "arena ladder": self.ladder,
            "arena break": self.break_,
            # of what takes its time, or a robot
            **dict.fromkeys(
                ("arena trainings", "arena compare-real", "arena iso18646", "arena compile"), lambda words: None
            ),
            **{
                "arena ros": self.ros,
                "arena render": read_picture,
                "arena replay": read_replay,
                "arena studio": read_studio,
            },
            **dict.fromkeys(("arena verify", "arena leaderboard"), lambda words: None),  # of packs of whole benchmarks
            **dict.fromkeys(
                ("arena reference", "arena explain", "arena cost", "arena export"), lambda words: None
            ),  # of runs
            **{
                "arena crowd": self.crowd,
                "arena check": self.check,
                "make": self.make,
                "pip": self.pip,
                "python": self.python,
            },
            **{"for": self.loop, ".": lambda words: None, "git": lambda words: None},
        }
        if kind.startswith("scripts/"):
            assert (TOP / kind).is_file()
        elif kind in known:
            known[kind](words[1:] if " " not in kind else words[2:])
        else:
            assert words[0] == "arena"
            assert words[1] in COMMANDS
            # one of its problems is, and the status says so
            impossible = words[1:3] == ["scenario", "check"] and "scenes.json" in words
            assert self.arena(*words[1:]).status == impossible
        return None

    def refused(self, line, after):
        """The documentation shows the refusal: it is the one that comes, up to what is installed elsewhere."""
        absent = re.search(r"comes with arena-(\w+), which is not installed", after)
        with pytest.MonkeyPatch.context() as patch:
            if absent:
                patch.setenv("ARENA_DISABLED_PLUGINS", f"{absent[1]},aio")  # AIO's presets are made of other planners
                patch.setattr("arena_core.base.suite._install_state", lambda name: f"not installed: pip install {name}")
            answer = self.arena(*shlex.split(line)[1:], "hydra.run.dir=run")
        assert answer.status == 2
        assert answer.line.partition("(possible")[0] == after.partition("(possible")[0]

    def composed(self, words):
        composed(split_out(words)[0])

    def ladder(self, words):
        if words[0] != "report":
            composed(["experiment=ladder", *(word for word in words if word.partition("=")[0] not in LADDER_KEYS)])

    def break_(self, words):
        if words[0] not in ACTIONS:
            own = [word for word in words if word.partition("=")[0] in ("planner", "robot", "world")]
            composed([*own, *(word for word in words if word.partition("=")[0] not in BREAK_KEYS)])

    def profile(self, words):
        composed([word for word in words if not word.startswith(("first=", "functions=", "out="))])

    def train(self, words):
        recipe = ["recipe=" + word.partition("=")[2] for word in words if word.startswith("planner=")]
        composed(
            [*recipe, *(word for word in words if not word.startswith(("planner=", "out=", "resume=", "test=")))],
            "train",
        )

    def tune(self, words):
        """Read the request, and compose the first cell of its problems: the others differ by numbers."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("arena_tuning.command.compose_cells", first_cell)
            read_tuning([word for word in words if not OWN.search(word)], load_registry())

    def quickstart(self, words):
        """Compose what it drives; tests/test_quickstart.py drives it."""
        assert all(word.startswith(("out=", "open=")) for word in words)
        composed(["experiment=quickstart", "planner=dwa,orca"])

    def navrep(self, words):
        stage, *rest = words
        if stage == "evidence":
            assert all(word.startswith(("policy=", "out=", "episodes=", "seed=")) for word in rest)
        else:
            assert stage in (*STAGES, "all")
            composed([word for word in rest if not word.startswith(("out=", "resume="))], "world_model")

    def predict(self, words):
        stage, *rest = words
        assert stage in FORESIGHT_STAGES
        own = ("horizon=", "miss=", "out=", "resume=")
        composed([word for word in rest if not word.startswith(own)], "predict" if stage == "train" else "config")

    def ros(self, words):
        action, *rest = words
        assert action in USAGES
        own = {"drive": DRIVE_KEYS, "simulate": SIMULATE_KEYS, "controller": CONTROLLER_KEYS}
        if action in own:
            composed([word for word in rest if "=" in word and word.partition("=")[0] not in own[action]])
        elif action in ("import", "scenario-from"):
            assert {word.partition("=")[0] for word in rest if "=" in word} <= {*IMPORT_KEYS, *all_roles()}

    def crowd(self, words):
        what, *rest = words
        if what == "measure":
            read_request(rest)
            return
        assert what == "validate"
        assert {word for word in rest if "=" not in word} <= set(EXPERIMENTS)
        composed([word for word in rest if word.startswith("pedestrians")], "component")

    def check(self, words):
        if words == ["planner=my_planner"]:
            assert self.arena("check", *words).status == 0
        elif words[0].startswith("tune="):
            assert words[0].partition("=")[2] in option_files("tune", load_registry().manager)
        elif words != ["all"]:
            composed(words, "train" if words[0].startswith("recipe=") else "component")

    def make(self, words):
        make_once(tuple(words))

    def pip(self, words):
        """Nothing is on an index yet: what is installed is a checkout, or arena-suite from the wheels of
        one, with extras that it has.
        """
        assert words[0] == "install"
        if words[1] == "-e":
            self.install(Path(words[2]))
            return
        name, extras = re.fullmatch(r"([a-z-]+)(?:\[([a-z,-]+)\])?", words[-1]).groups()
        assert words[1:-1] == ["--find-links", "dist"]
        assert name == "arena-suite"
        assert set(extras.split(",") if extras else ()) <= set(SUITE["optional-dependencies"])

    def install(self, folder):
        """Make a package that ``arena new`` wrote look installed."""
        if not folder.is_dir():
            assert (TOP / "plugins" / folder).is_dir()
            return
        said = tomllib.loads((folder / "pyproject.toml").read_text())["project"]
        ((name, module),) = said["entry-points"]["arena"].items()
        self.third_party.write(
            f"{module}-0.1.0.dist-info/METADATA", f"Metadata-Version: 2.1\nName: {said['name']}\nVersion: 0.1.0\n"
        )
        self.third_party.write(f"{module}-0.1.0.dist-info/entry_points.txt", f"[arena]\n{name} = {module}\n")
        os.symlink(folder.resolve() / module, self.third_party.folder / module)

    def python(self, words):
        if words[0] == "-m":
            assert words[1] == "benchmarks"
            assert all((TOP / "benchmarks" / f"bench_{word}.py").is_file() for word in words[2:])
            return
        text = (TOP / words[0]).read_text()
        assert all(f'"{word}"' in text for word in words[1:] if word.startswith("--"))

    def loop(self, words):
        inner = " ".join(words).partition("; do ")[2].partition(";")[0]
        self(re.sub(r"\$\w+", "0", inner), "")


def project(folder):
    return tomllib.loads((TOP / folder / "pyproject.toml").read_text())["project"]


SUITE = project("plugins/arena-suite")


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: block.name)
def test_commands_of_the_documentation_can_be_given(block, shell):
    for line, after in block.commands:
        shell(line, after)


def test_there_are_commands():
    assert len([line for block in BLOCKS for line, _ in block.commands]) > 150


def test_what_is_installed_first_is_the_suite_with_the_first_planner():
    first = next(
        line for block in BLOCKS if block.page == "README.md" for line, _ in block.commands if line.startswith("pip ")
    )
    assert shlex.split(first) == ["pip", "install", "--find-links", "dist", "arena-suite[dwa]"]


def named():
    """Yield what is named in running text: `make target`, `arena command`, `scripts/file`, `python file`."""
    for path in PAGES:
        text = re.sub(r"^```.*?^```$", "", path.read_text(), flags=re.M | re.S)
        for kind, name in re.findall(r"`(make|arena|python(?: -m benchmarks)?) ([a-z-][\w./-]*)[^`]*`", text):
            if "NAME" not in name:
                yield path.relative_to(TOP), kind, name
        files = re.findall(r"`(scripts/[\w.]+)[^`]*`", text)
        yield from ((path.relative_to(TOP), "file", name) for name in files if "NAME" not in name)


def test_what_running_text_names_is_there():
    targets = set(re.findall(r"^([\w-]+):", (TOP / "Makefile").read_text(), re.M)) | {
        "test-browser",
        "test-ros1",
        "test-ros2",
    }
    for page, kind, name in set(named()):
        there = {
            "make": name in targets,
            "arena": name in COMMANDS or name in ("--help", "--version"),
            "python": name == "-m" or (TOP / name).is_file(),
            "python -m benchmarks": name == "--against" or (TOP / "benchmarks" / f"bench_{name}.py").is_file(),
            "file": (TOP / name).is_file(),
        }
        assert there[kind], (page, kind, name)


def test_choices_takes_what_a_run_takes():
    assert "[KEY=VALUE ...]" in CHOICES
