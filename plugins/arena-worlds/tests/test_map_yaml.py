"""A map's YAML is read as ROS reads it, and each slip is one line with file, key and what is allowed."""

from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from arena_core import InputFileError
from arena_worlds.formats.map_yaml import read_map_yaml

EXACT = settings(derandomize=True, deadline=None, max_examples=100)
GOOD: dict[str, Any] = {
    "image": "map.png",
    "resolution": 0.05,
    "origin": [-1.0, 2.0, 0.5],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("maps")
    Image.new("L", (4, 3), 254).save(path / "map.png")
    return path


def write(folder: Path, text: str) -> Path:
    path = folder / "site.yaml"
    path.write_text(text)
    return path


def test_every_key_is_read(folder: Path) -> None:
    found = read_map_yaml(write(folder, yaml.safe_dump({**GOOD, "mode": "scale", "negate": True, "something_else": 3})))
    assert found.image == folder / "map.png"
    assert (found.resolution, found.origin, found.negate) == (0.05, (-1.0, 2.0, 0.5), True)
    assert (found.occupied_thresh, found.free_thresh, found.mode) == (0.65, 0.196, "scale")


def test_mode_may_be_left_out_and_numbers_may_be_whole_or_in_exponents(folder: Path) -> None:
    found = read_map_yaml(
        write(
            folder,
            "image: map.png\nresolution: 5e-2\norigin: [0, 1, 0]\nnegate: 0\noccupied_thresh: 1\nfree_thresh: 0\n",
        )
    )
    assert (found.mode, found.resolution, found.origin, found.occupied_thresh) == (
        "trinary",
        0.05,
        (0.0, 1.0, 0.0),
        1.0,
    )


def test_absolute_image_path(folder: Path) -> None:
    assert (
        read_map_yaml(write(folder, yaml.safe_dump({**GOOD, "image": str(folder / "map.png")}))).image
        == folder / "map.png"
    )


@pytest.mark.parametrize("key", sorted(GOOD))
def test_missing_key_is_named(folder: Path, key: str) -> None:
    path = write(folder, yaml.safe_dump({k: v for k, v in GOOD.items() if k != key}))
    with pytest.raises(InputFileError, match=rf"site\.yaml: {key} is missing; allowed: "):
        read_map_yaml(path)


@pytest.mark.parametrize(
    ("key", "value", "allowed"),
    [
        ("image", 3, "an image file"),
        ("image", "", "an image file"),
        ("image", "gone.pgm", "an image file"),
        ("resolution", 0, "> 0"),
        ("resolution", -0.05, "> 0"),
        ("resolution", "fine", "a finite number"),
        ("resolution", True, "a finite number"),
        ("resolution", float("nan"), "a finite number"),
        ("origin", [0.0, 0.0], r"\[x, y, yaw\]"),
        ("origin", [0.0, 0.0, "east"], r"\[x, y, yaw\]"),
        ("origin", 0.0, r"\[x, y, yaw\]"),
        ("negate", 2, "0 or 1"),
        ("negate", "no way", "0 or 1"),
        ("negate", [0], "0 or 1"),
        ("occupied_thresh", 1.2, "0 <= free_thresh <= occupied_thresh <= 1"),
        ("free_thresh", -0.1, "0 <= free_thresh <= occupied_thresh <= 1"),
        ("free_thresh", 0.7, "0 <= free_thresh <= occupied_thresh <= 1"),
        ("mode", "binary", "trinary, scale or raw"),
        ("mode", ["raw"], "trinary, scale or raw"),
    ],
)
def test_wrong_value_says_key_and_what_is_allowed(folder: Path, key: str, value: object, allowed: str) -> None:
    path = write(folder, yaml.safe_dump({**GOOD, key: value}))
    with pytest.raises(InputFileError, match=rf"site\.yaml: .*{key}.*; allowed: .*{allowed}") as caught:
        read_map_yaml(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "just words",
        "- a\n- list",
        "image: [unclosed",
        "a: b: c",
        "\t- x",
        "image: !!python/object:os.system {}",
        "d: 2020-13-45",
    ],
)
def test_text_that_is_no_map_yaml(folder: Path, text: str) -> None:
    path = write(folder, text)
    with pytest.raises(InputFileError, match=r"site\.yaml: ") as caught:
        read_map_yaml(path)
    assert "\n" not in str(caught.value)


def test_missing_file_and_folder_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match=r"nowhere\.yaml: cannot be read \(No such file"):
        read_map_yaml(tmp_path / "nowhere.yaml")
    with pytest.raises(InputFileError, match="cannot be read"):
        read_map_yaml(tmp_path)


@EXACT
@given(st.binary(max_size=60))
def test_any_bytes_give_one_line(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.mktemp("bytes") / "map.yaml"
    path.write_bytes(content)
    with pytest.raises(InputFileError) as caught:
        read_map_yaml(path)
    assert "\n" not in str(caught.value)


ODD = (
    st.none()
    | st.booleans()
    | st.integers(-(10**400), 10**400)
    | st.floats()
    | st.text(max_size=5)
    | st.lists(st.floats(), max_size=4)
)


@EXACT
@given(st.sampled_from(sorted(GOOD)), ODD)
def test_any_value_is_taken_or_refused_in_one_line(folder: Path, key: str, value: object) -> None:
    path = write(folder, yaml.safe_dump({**GOOD, key: value}))
    refusal = ""
    try:
        found = read_map_yaml(path)
    except InputFileError as error:
        refusal = str(error)
    if refusal:
        assert key in refusal
        assert "\n" not in refusal
    else:
        assert 0.0 <= found.free_thresh <= found.occupied_thresh <= 1.0
        assert 0.0 < found.resolution < float("inf")
