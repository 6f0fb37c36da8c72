"""`arena predict train`: which drives it learns from, that it goes on where it was, what it writes and refuses."""

from __future__ import annotations

import dataclasses
import io
import json
import shutil
from functools import cache

import numpy as np
import pytest

from arena_core import ConfigurationError, InputFileError, Tracks, testing
from arena_core.hosting import compose, load_registry, to_plain
from arena_core.parameters import read_settings
from arena_gym.prediction.problems import SEEDS_APART, SEEDS_FROM, block_words
from arena_gym.prediction.settings import Between, DriveSettings, check_drives
from arena_prediction.drives import Drive, load_drive, save_drive, true_tracks
from arena_prediction.predict_command import PredictCommand

SMALL = (
    "trainer.drives.blocks=2",
    "trainer.drives.episodes=1",
    "trainer.drives.validation=1",
    "trainer.drives.time_limit=8.0",
    "trainer.fit.batch=64",
    "trainer.fit.width=16",
    "trainer.fit.neighbour_width=8",
    "trainer.fit.times=4",
)


@cache
def drive_settings():
    return read_settings(to_plain(compose((), "predict"))["trainer"]["drives"], DriveSettings, "trainer.drives")


@pytest.fixture(scope="module")
def blocks():
    """Return the words of the first 200 blocks of seed 0."""
    return [block_words(drive_settings(), 0, block) for block in range(200)]


def test_every_training_drive_has_a_seed_of_its_own_above_those_of_tests(blocks):
    seeds = [int(words[0].removeprefix("seed=")) for words in blocks]
    assert min(seeds) >= SEEDS_FROM
    assert len(set(seeds)) == len(seeds)
    assert drive_settings().blocks <= SEEDS_APART


def test_two_trainings_share_no_seed(blocks):
    other = {block_words(drive_settings(), 1, block)[0] for block in range(200)}
    assert not other & {words[0] for words in blocks}


def test_people_who_are_recorded_or_walk_by_orca_are_never_learned_from(blocks):
    crowds = {word for words in blocks for word in words if word.startswith("pedestrians=")}
    assert crowds == {"pedestrians=social_force", "pedestrians=social_force_lively"}


def test_both_profiles_and_all_kinds_of_worlds_are_learned_from(blocks):
    said = {word for words in blocks for word in words}
    assert {"people=slow", "people=lifelike"} <= said
    assert {f"world={world}" for world in drive_settings().worlds} <= said
    assert {"localizer=amcl", "tracker=kalman"} <= said


def test_a_block_is_drawn_by_seed_and_number_alone():
    assert block_words(drive_settings(), 3, 5) == block_words(drive_settings(), 3, 5)


def drive_of_two():
    rng = np.random.default_rng(0)
    tracks = [testing.people(0.1 * k) for k in range(4)]
    tracks[2] = Tracks(*(getattr(tracks[2], name)[:0] for name in Tracks.__slots__))
    people = rng.normal(size=(4, 2, 2))
    people[0, 1] = np.nan
    return Drive(0.1 * np.arange(4), tuple(tracks), testing.room(), people, 0.1 * people, np.array((0.3, 0.25)))


def test_a_drive_is_read_as_it_was_written(tmp_path):
    driven = drive_of_two()
    save_drive(tmp_path / "0.npz", driven)
    read = load_drive(tmp_path / "0.npz")
    np.testing.assert_allclose(read.people, driven.people, rtol=1e-6)
    assert [len(each.ids) for each in read.tracks] == [3, 3, 0, 3]
    for name in Tracks.__slots__:
        np.testing.assert_allclose(getattr(read.tracks[3], name), getattr(driven.tracks[3], name), rtol=1e-6)
    np.testing.assert_array_equal(read.grid.occupied, driven.grid.occupied)
    assert read.grid.origin == driven.grid.origin


def test_true_tracks_are_of_those_who_are_there():
    found = true_tracks(drive_of_two())
    assert [each.ids.tolist() for each in found] == [[0], [0, 1], [0, 1], [0, 1]]
    assert not found[0].covariances.any()


def foreign_arrays():
    file = io.BytesIO()
    np.savez(file, numbers=np.zeros(3))
    return file.getvalue()


@pytest.mark.parametrize("content", [b"", b"nothing", b"PK\x03\x04", foreign_arrays()])
def test_a_file_that_is_no_drive_is_refused(tmp_path, content):
    path = tmp_path / "0.npz"
    path.write_bytes(content)
    with pytest.raises(InputFileError, match=r"0\.npz.*allowed: a drive that `arena predict train` wrote"):
        load_drive(path)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"validation": 400}, "validation is 400; allowed: fewer than blocks (400)"),
        ({"worlds": {}}, "worlds is {}; allowed: names with weights, one above 0"),
        ({"people": {"slow": 0.0}}, "people is {'slow': 0.0}; allowed: names with weights, one above 0"),
        ({"robots": []}, "robots is []; allowed: one robot or more"),
        ({"pace": Between(2.0, 1.0)}, "pace is 2 to 1; allowed: low not above high"),
    ],
)
def test_drives_that_cannot_be_drawn_are_refused(changes, said):
    with pytest.raises(ConfigurationError) as error:
        check_drives(dataclasses.replace(drive_settings(), **changes))
    assert str(error.value) == f"trainer.drives.{said}"


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("trainer.drives.validation=400", "validation is 400"),
        ("trainer.drives.worlds.indoor=-1", "indoor"),
        ("trainer.fit.hypotheses=0", "hypotheses"),
        ("trainer.fit.share=1.5", "share"),
        ("trainer.drives.nothing=1", "nothing"),
        ("trainer.name=nothing", "nothing"),
        ("seed=-1", "seed"),
        ("resume=maybe", "resume"),
    ],
)
def test_settings_that_cannot_be_are_refused_before_anything_is_driven(tmp_path, monkeypatch, word, said):
    pytest.importorskip("torch")
    from arena_gym.prediction import trainer

    monkeypatch.setattr(trainer, "record_drives", lambda *_: pytest.fail("it drives"))
    with pytest.raises(ConfigurationError, match=said) as error:
        PredictCommand().run(["train", f"out={tmp_path / 'it'}", word])
    assert "\n" not in str(error.value)
    assert not (tmp_path / "it").exists()


@pytest.mark.slow
def test_a_training_goes_on_where_it_was_and_ends_as_one_that_never_stopped(tmp_path):
    pytest.importorskip("torch")
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    PredictCommand().run(["train", f"out={whole}", *SMALL, "trainer.fit.epochs=2"])
    shutil.copytree(whole, parts)
    (parts / "people.onnx").unlink()
    (parts / "drives" / "0001.done").unlink()
    PredictCommand().run(["train", f"out={parts}", *SMALL, "trainer.fit.epochs=2", "resume=true"])
    assert (parts / "people.json").read_text() == (whole / "people.json").read_text()
    card = json.loads((whole / "people.json").read_text())
    assert len(card["training"]["curve"]) == 2
    node = to_plain(compose(["predictor=learned", f"predictor.network={whole / 'people.onnx'}"]))["predictor"]
    testing.check("predictor", load_registry().build("predictor", node, robot=testing.robot()), testing.robot())
    with pytest.raises(ConfigurationError, match="resume=true"):
        PredictCommand().run(["train", f"out={parts}", *SMALL, "trainer.fit.epochs=2"])
