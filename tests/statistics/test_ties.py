"""Ties of a sweeper's best trial: those of the same value, and those that its episodes do not tell from it."""

import pytest

from hydra_plugins.arena.ties import find_ties


def write_trial(folder, values):
    folder.mkdir(parents=True)
    rows = [f"{number},{value}" for number, value in enumerate(values)]
    (folder / "episodes.csv").write_text("\n".join(["episode,spl", *rows]) + "\n")


@pytest.fixture
def sweep(tmp_path):
    best = [1.0, 0.9, 0.8, 1.0, 0.7, 0.9, 1.0, 0.8]
    write_trial(tmp_path / "2", best)
    write_trial(tmp_path / "10", best[::-1])
    write_trial(tmp_path / "3", [value - 0.5 for value in best])
    write_trial(tmp_path / "4", [*best[:-1], ""])
    (tmp_path / "report").mkdir()
    return tmp_path


def test_trials_of_the_same_value_and_those_not_told_apart_are_ties(sweep):
    ties = find_ties(sweep, "spl", 0.8875)
    assert (ties.equal, ties.not_told_apart, ties.trials) == (["10"], 2, 4)


def test_best_of_which_no_trial_is_there_has_no_ties(sweep):
    assert find_ties(sweep, "spl", 0.123).equal == ()
