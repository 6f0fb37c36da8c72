"""Bounds of common sense: those that ship, and files of a user's."""

import pytest

from arena_break.bounds import read_bounds
from arena_core import InputFileError


def test_what_ships_is_common_sense():
    bounds = read_bounds(None)
    assert bounds.people.fastest <= 1.6
    assert bounds.people.spawn_distance >= 3.0
    assert len(set(bounds.keys)) == 3
    assert bounds.genes == 5 + 6 * bounds.people.most


def test_a_file_says_what_differs_and_the_rest_is_as_it_ships(tmp_path):
    (tmp_path / "mine.yaml").write_text("people: {most: 2}\nbatch: 6\n")
    bounds, shipped = read_bounds(str(tmp_path / "mine.yaml")), read_bounds(None)
    assert (bounds.people.most, bounds.batch, bounds.people.fastest) == (2, 6, shipped.people.fastest)
    assert bounds.robot == shipped.robot


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("people: {fastest: 2.5}", r"people\.fastest is 2\.5"),
        ("people: {spawn_distance: 1.0}", r"people\.spawn_distance is 1\.0"),
        ("people: {slowest: 1.5, fastest: 1.2}", r"people\.slowest is 1\.5; allowed: up to people\.fastest, 1\.2"),
        ("robot: {min_distance: 30}", r"robot\.min_distance is 30; allowed: up to robot\.max_distance, 16"),
        ("keys: []", "keys is"),
        ("keys: [1, 1]", "each once"),
        ("walkers: {most: 3}", "walkers"),
        ("batch: 0", "batch is 0"),
    ],
)
def test_a_wrong_bound_is_one_line_with_file_and_key(tmp_path, text, said):
    (tmp_path / "mine.yaml").write_text(text)
    with pytest.raises(InputFileError, match=said) as caught:
        read_bounds(str(tmp_path / "mine.yaml"))
    assert "mine.yaml" in str(caught.value)
    assert "\n" not in str(caught.value)
