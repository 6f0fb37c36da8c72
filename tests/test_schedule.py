"""How often a growing table is written, and what is said where its folder goes meanwhile."""

import shutil
from collections import UserDict
from time import monotonic

import pytest

from arena_core.base.errors import RunFolderError
from arena_core.base.folders import FolderLost, check_writable, folder_identity
from arena_core.contracts.running import Finished, Job
from arena_core.runs.folders.schedule import WRITE_EVERY, WRITE_SHARE, OpenRun
from arena_core.runs.jobs.code_digest import Code


@pytest.mark.parametrize(
    ("since", "took", "written"),
    [
        (-3600.0, 0.0, False),  # as just written, however busy the machine is
        (WRITE_EVERY + 0.1, 0.0, True),
        (WRITE_EVERY + 0.1, 1000.0, False),
        (1000.0 / WRITE_SHARE + 0.1, 1000.0, True),
    ],
)
def test_a_table_that_takes_long_is_written_less_often(tmp_path, since, took, written):
    run = OpenRun({"episodes": 2}, tmp_path, {}, None, Code("", {}), written=monotonic() - since, write_took=took)
    job = Job({}, str(tmp_path), 1)
    run.take(Finished(job, {"episode": 1, "outcome": "goal_reached"}, True))
    assert run.left() == 1
    assert (tmp_path / "episodes.csv").exists() == written


class Rows(UserDict):
    """Rows whose reading moves the folder that they are to be written to."""

    def __init__(self, folder):
        super().__init__()
        self.folder = folder

    def keys(self):
        shutil.move(self.folder, self.folder.with_name("away"))
        self.folder.touch()  # so that the table cannot be written
        return super().keys()


def test_a_folder_that_goes_while_its_table_is_written_is_said_to_have_gone(tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    run = OpenRun({"episodes": 2}, folder, {}, None, Code("", {}), rows=Rows(folder), place=folder_identity(folder))
    with pytest.raises(RunFolderError, match="/run was moved, removed or replaced while its run was under way"):
        run.write()


def test_a_folder_that_goes_while_a_record_is_written_is_said_to_have_gone(tmp_path):
    with pytest.raises(FolderLost, match="/run was moved or removed while its run"), check_writable(tmp_path / "run"):
        raise RunFolderError("cannot write it")
