"""The first result: which planners, where, and that it is one."""

import subprocess
import sys
from pathlib import Path

import pytest

from arena_core.base.errors import ConfigurationError
from arena_core.cli.quickstart import first_planners, free_name


class Installed:
    def __init__(self, *planners):
        self._planners = planners

    def names(self, kind):
        return list(self._planners)


def test_the_planners_that_compile_soonest_are_compared():
    assert first_planners(Installed("mpc", "orca", "teb", "dwa", "mine")) == ["dwa", "orca"]
    assert first_planners(Installed("mine", "teb")) == ["teb"]


def test_without_a_planner_it_says_which_could_be_installed():
    with pytest.raises(ConfigurationError, match=r"allowed: one of arena-dwa, .*, arena-pure-pursuit$"):
        first_planners(Installed())


def test_each_time_it_takes_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("quickstart", "quickstart-2", "quickstart-3"):
        assert free_name("quickstart") == name
        Path(name).mkdir()


def test_the_core_runs_as_a_module():
    said = subprocess.run([sys.executable, "-m", "arena_core", "--version"], capture_output=True, text=True, check=True)
    assert said.stdout.startswith("arena 0.")


@pytest.mark.slow
def test_two_planners_drive_on_drawn_maps_and_a_page_compares_them(arena):
    answer = arena("quickstart", "open=false", "out=first")
    assert answer.status == 0
    assert Path("first/report/index.html").is_file()
    assert "  arena replay first/0 0 " in answer.out
    assert all(Path("first", run, "episodes.csv").is_file() for run in ("0", "1"))
    assert len({path.name for run in ("0", "1") for path in Path("first", run, "worlds").iterdir()}) == 6
