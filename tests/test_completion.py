import os
import pty
import select
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from arena_core.cli.completion import SHELLS, next_words

HEAVY = ("numba", "torch", "casadi", "pandas", "matplotlib", "scipy", "shapely", "hydra", "omegaconf")
START = {"bash": ("bash", "--norc", "--noprofile", "-i"), "zsh": ("zsh", "-f", "-i")}
QUIET = {
    "bash": "PS1='> '; bind 'set enable-bracketed-paste off'; bind 'set bell-style none'",
    "zsh": "PS1='> '; unsetopt beep zle_bracketed_paste",
}


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("li", ["list"]),
        ("completion ", ["bash", "zsh"]),
        ("list expe", ["experiment"]),
        ("run planner=pure", ["planner=pure_pursuit"]),
        ("run -m planner=pure_pursuit,dw", ["planner=pure_pursuit,dwa", "planner=pure_pursuit,dwa_as_released"]),
        ("run experiment=sm", ["experiment=smoke"]),
        ("run plan", ["planner="]),
        ("run rec", ["recording.", "recoveries="]),
        ("run timing.m", ["timing.mode="]),
        ("run planner=pure_pursuit planner.s", ["planner.speed="]),
        ("run +planner=pure_pursuit ++planner.s", ["++planner.speed="]),
        ("run metrics=[barn,s", ["metrics=[barn,si", "metrics=[barn,social", "metrics=[barn,survey"]),
        ("run metrics.si.personal", ["metrics.si.personal_space="]),
        ("run stop_on_collision=", ["stop_on_collision=false", "stop_on_collision=true"]),
        ("run episodes=", []),
        ("run --cfg ", ["all", "hydra", "job"]),
        ("run --c", ["--cfg"]),
        ("check tracker=", ["tracker=ground_truth", "tracker=kalman", "tracker=kalman_legs", "tracker=none"]),
        ("check al", ["all"]),
        ("check planner=pure_pursuit planner.g", ["planner.gain="]),
        ("evaluate runs metrics=s", ["metrics=si", "metrics=social", "metrics=survey"]),
        ("report --no", ["--no-figures"]),
        ("train planner=gri", ["planner=gring", "planner=gring_as_released"]),
        ("train training.va", ["training.validation."]),
        ("navrep mem", ["memory"]),
        ("world gen", ["generate"]),
        ("world generate kind=ware", ["kind=warehouse"]),
        ("scenario conv", ["convert"]),
        ("crowd validate pedestrians=or", ["pedestrians=orca"]),
        ("choices robot=rob", ["robot=robotino"]),
        ("export runs to=s", ["to=socnav.json"]),
        ("nothing ", []),
    ],
)
def test_the_last_word_is_completed(line, found, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert next_words(line.split(" ")) == found


def test_a_package_and_a_folder_of_ones_own_are_completed_too(third_party, tmp_path, monkeypatch):
    third_party.package("calm", CALM, {"planner/calm": "name: calm\npatience: 2.0  # [s] how long\n"})
    (tmp_path / "conf" / "robot").mkdir(parents=True)
    (tmp_path / "conf" / "robot" / "my_own.yaml").write_text("defaults: [jackal, _self_]\n")
    monkeypatch.chdir(tmp_path)
    assert next_words(["run", "planner=calm", "planner."]) == ["planner.patience="]
    assert next_words(["run", "robot=my"]) == ["robot=my_own"]
    assert "robot.lidar." in next_words(["run", "robot=my_own", "robot."])


CALM = """
    from arena_core import Planner, hookimpl

    @hookimpl
    def register_planners(register):
        register("calm", Planner)

    @hookimpl
    def config_package():
        return "calm.conf"
"""


def test_completing_loads_no_heavy_library(tmp_path):
    code = f"""import sys; from arena_core.cli.completion import next_words
next_words(["run", "planner=teb", "planner.l"]); print([m for m in {HEAVY} if m in sys.modules])"""
    answer = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=600, check=True, cwd=tmp_path
    )
    assert answer.stdout == "[]\n"


def test_an_unknown_shell_is_refused(arena, capfd):
    with pytest.raises(SystemExit):
        arena("completion", "fish")
    assert "choose from 'bash', 'zsh'" in capfd.readouterr().err


@pytest.mark.parametrize("shell", [shell for shell in SHELLS if shutil.which(shell)])
def test_a_shell_completes_what_is_typed(shell, tmp_path):
    (tmp_path / "single_run").mkdir()
    with Terminal(START[shell], tmp_path) as terminal:
        terminal.type(QUIET[shell] + "\n")
        terminal.type('eval "$(arena completion ' + shell + ')" && echo re""ady\n', "ready\n")
        terminal.type("arena lis\t", "arena list ")
        terminal.type("expe\t", "experiment")
        terminal.type("\x15arena run planner=pure_p\t", "planner=pure_pursuit ")
        terminal.type("planner.gai\t", "planner.gain=")
        terminal.type("\x15arena report sing\t", "single_run")


class Terminal:
    """An interactive shell in a terminal of its own; a wait for what does not come fails with all that has come."""

    def __init__(self, words, folder):
        self._file, theirs = pty.openpty()
        environment = {
            **os.environ,
            "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
            "TERM": "dumb",
            "HOME": str(folder),
        }
        streams = dict.fromkeys(("stdin", "stdout", "stderr"), theirs)
        self._process = subprocess.Popen(words, cwd=folder, env=environment, start_new_session=True, **streams)
        os.close(theirs)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()
        os.close(self._file)

    def type(self, text, awaited=""):
        """Type a text, and wait until the shell has answered with what is awaited."""
        os.write(self._file, text.encode())
        shown, until = "", time.monotonic() + 600.0
        while awaited not in shown.replace("\r", ""):
            assert time.monotonic() < until, f"no {awaited!r} in {shown!r}"
            if select.select([self._file], [], [], 0.1)[0]:
                shown += os.read(self._file, 4096).decode(errors="replace")
