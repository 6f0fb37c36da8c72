"""`arena check` tries everything that is installed."""

import pytest


@pytest.mark.slow
def test_everything_installed_holds_its_contract_or_needs_a_file(arena):
    answer = arena("check", "all")
    lines = answer.out.splitlines()
    assert answer.status == 0, [line for line in lines if line.startswith("BROKEN")]
    assert {line.split()[1] for line in lines if line.startswith("--")} == {
        "world=barn",
        "world=file",
        "world=ros_map",
        "world=scenario_map",
        "task=barn",
        "task=scenario",
    }
