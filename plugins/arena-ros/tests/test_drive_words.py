"""What ``arena ros drive`` refuses before it asks for a robot."""

from pathlib import Path

import pytest

from arena_core.cli.main import main
from arena_ros.testing import write_site


def test_a_live_file_is_refused_where_topics_show_a_drive(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    site = write_site(tmp_path)
    words = [
        f"map={site}/map.yaml",
        "planner=pure_pursuit",
        "robot=jackal",
        "recording.live=true",
        f"out={tmp_path}/run",
    ]
    assert main(["ros", "drive", *words]) == 2
    assert (
        capsys.readouterr()
        .err.splitlines()[-1]
        .startswith("arena: recording.live is true; allowed with arena ros drive: false")
    )
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("word", ["tracker=ground_truth", "predictor=truth"])
def test_what_sees_the_truth_is_refused_where_nobody_tells_it(
    word: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    site = write_site(tmp_path)
    words = [f"map={site}/map.yaml", "planner=pure_pursuit", "robot=jackal", word, f"out={tmp_path}/run"]
    assert main(["ros", "drive", *words]) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert said.startswith(f"arena: {word.replace('=', ' ')} would see the truth, which no real robot tells")
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("namespace", ["/robot1/", "robot 1", "/1", "/"])
def test_a_namespace_that_is_no_name_of_ros_is_refused(
    namespace: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [f"map={tmp_path}/map.yaml", "planner=pure_pursuit", "robot=jackal", f"namespace={namespace}"]
    assert main(["ros", "drive", *words]) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert said == f"arena: namespace is {namespace}; allowed: a name of ROS, such as /robot1"
