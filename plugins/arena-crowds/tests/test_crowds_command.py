import csv

import pytest

from arena_core.cli.main import main
from arena_crowds.validation import door


def test_an_experiment_writes_a_table_and_a_picture(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(door, "WIDTHS", (1.2,))
    monkeypatch.setattr(door, "HURRIES", (1.34,))
    monkeypatch.setattr(door, "SEEDS", 1)
    monkeypatch.setattr(door, "SECONDS", 3.0)
    assert (
        main(
            [
                "crowd",
                "validate",
                "door",
                "pedestrians=orca,social_force",
                "pedestrians.reaction=yield",
                f"out={tmp_path}",
            ]
        )
        == 0
    )
    with (tmp_path / "door.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["who"] for row in rows] == ["orca", "orca", "social_force", "social_force"]
    assert (tmp_path / "door.png").read_bytes().startswith(b"\x89PNG")
    assert "flow_per_m_s" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["doors"], "has no experiment 'doors' (possible: speed_density, lanes, door, rollout)"),
        (["door", "widths=2"], "there is no key widths; allowed: arena crowd validate"),
        (["rollout"], "rollout needs a recording; allowed: recordings=DIR"),
        (["rollout", "recordings=/nowhere"], "/nowhere/ucy/zara01/obsmat.txt.gz"),
        (["speed_density", "recordings=/nowhere"], "/nowhere: no juelich/uo-*.txt below it"),
        (["door", "pedestrians=orcas"], "orcas"),
        (["door", "pedestrians=orca", "pedestrians.horizon=-1"], "pedestrians.horizon is -1"),
    ],
)
def test_a_wrong_request_is_one_line(arguments, says, capsys):
    assert main(["crowd", "validate", *arguments]) == 2
    error = capsys.readouterr().err
    assert says in error
    assert len(error.strip().splitlines()) == 1


def test_the_usage_names_the_experiments(capsys):
    assert main(["crowd"]) == 0
    assert "rollout" in capsys.readouterr().out
