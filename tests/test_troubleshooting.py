"""The lines that docs/troubleshooting.md explains are those that the program prints."""

import re
from pathlib import Path

import pytest

from arena_core.cli.main import main

TOP = Path(__file__).resolve().parents[1]
TEXT = re.sub(r"\s+", " ", (TOP / "docs" / "troubleshooting.md").read_text())
REQUESTS = {  # words after `arena run`: what the page quotes of the answer
    "planner=dwx": "unknown planner 'dwx'; did you mean dwa? (possible: ",
    "planer=dwa": "the configuration has no key planer; did you mean planner?",
    "planner=dwa planner.horizon=9": "planner has no key horizon (possible: approach, ",
    "task.pedestrians=many": "task.pedestrians is 'many'; allowed: a whole number",
    "episodes=0": "episodes is 0; allowed: >= 1 and <= 100000",
    "world=ros_map world.path=nothere.yaml": "(No such file or directory); allowed: the YAML file of a map_server map",
}


@pytest.mark.parametrize("words", REQUESTS)
def test_the_page_quotes_what_a_wrong_request_prints(words, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert REQUESTS[words] in TEXT
    assert main(["run", *words.split()]) == 2
    assert REQUESTS[words] in capsys.readouterr().err


@pytest.mark.parametrize(
    "line",
    [
        "compiling kernels for this machine; this happens once and can take minutes",
        "an ONNX file with its card beside it",
        "resume=force runs these again and keeps the rest",
    ],
)
def test_other_lines_of_the_page_are_in_the_code(line):
    code = [path.read_text() for top in ("arena_core", "plugins") for path in (TOP / top).rglob("*.py")]
    assert line in TEXT
    assert any(line in text for text in code)
