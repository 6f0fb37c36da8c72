"""Pixels become the values that navigation2's map server gives them."""

import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from arena_core import InputFileError
from arena_worlds.formats.map_image import read_occupancy
from arena_worlds.formats.map_yaml import MapFile, Mode

EXACT = settings(derandomize=True, deadline=None, max_examples=80)


def values(
    image: Path, mode: Mode = "trinary", negate: bool = False, occupied: float = 0.65, free: float = 0.196
) -> NDArray[np.int8]:
    return read_occupancy(MapFile(image, 1.0, (0.0, 0.0, 0.0), negate, occupied, free, mode))


def grey_row(folder: Path, *greys: int) -> Path:
    path = folder / "row.png"
    Image.fromarray(np.array([greys], np.uint8)).save(path)
    return path


def test_first_row_of_the_image_is_the_top_of_the_map(tmp_path: Path) -> None:
    path = tmp_path / "map.png"
    Image.fromarray(np.array([[0, 0], [254, 254], [254, 0]], np.uint8)).save(path)
    assert values(path).tolist() == [[0, 100], [0, 0], [100, 100]]


def test_trinary_of_map_saver_greys(tmp_path: Path) -> None:
    # map_saver writes 0 occupied, 254 free and 205 unknown: 50 / 255 is just above the usual 0.196
    assert values(grey_row(tmp_path, 0, 254, 205)).tolist() == [[100, 0, -1]]


def test_a_value_at_a_threshold_is_neither_free_nor_occupied(tmp_path: Path) -> None:
    row = grey_row(tmp_path, 51, 153)
    assert values(row, negate=True, occupied=0.6, free=0.2).tolist() == [[-1, -1]]


def test_negate_takes_black_as_free(tmp_path: Path) -> None:
    assert values(grey_row(tmp_path, 0, 255), negate=True).tolist() == [[0, 100]]


def test_scale_spreads_the_values_between_the_thresholds(tmp_path: Path) -> None:
    row = grey_row(tmp_path, 255, 204, 153, 102, 51, 0)  # 0, 0.2, 0.4, 0.6, 0.8, 1 occupied
    assert values(row, "scale", occupied=0.8, free=0.2).tolist() == [[0, 0, 33, 67, 100, 100]]


def test_raw_takes_greys_up_to_100_and_ignores_negate(tmp_path: Path) -> None:
    row = grey_row(tmp_path, 0, 1, 100, 101, 255)
    assert values(row, "raw").tolist() == [[0, 1, 100, -1, -1]]
    assert values(row, "raw", negate=True).tolist() == [[0, 1, 100, -1, -1]]


def test_transparent_pixels_darken_trinary_and_are_unknown_in_scale(tmp_path: Path) -> None:
    path = tmp_path / "map.png"
    Image.fromarray(np.array([[[255, 255, 255, 255], [255, 255, 255, 0], [0, 0, 0, 0]]], np.uint8)).save(path)
    assert values(path).tolist() == [[0, -1, 100]]  # 0, 1/4 and 1 occupied
    assert values(path, "scale").tolist() == [[0, -1, -1]]


def test_colours_are_averaged(tmp_path: Path) -> None:
    path = tmp_path / "map.png"
    Image.fromarray(np.array([[[255, 255, 0], [255, 0, 0], [30, 0, 0]]], np.uint8)).save(path)
    assert values(path, occupied=0.5, free=0.35).tolist() == [[0, 100, 100]]
    assert values(path, "raw").tolist() == [[-1, 85, 10]]


def test_palette_with_transparency_counts_as_alpha(tmp_path: Path) -> None:
    image = Image.new("P", (2, 1))
    image.putpalette([255, 255, 255, 0, 0, 0])
    image.putdata([0, 1])
    image.save(tmp_path / "map.png", transparency=0)
    assert values(tmp_path / "map.png", "scale").tolist() == [[-1, 100]]


def test_sixteen_bit_greys(tmp_path: Path) -> None:
    path = tmp_path / "map.png"
    Image.fromarray(np.array([[0, 65535, 65535 * 3 // 5]], np.uint16)).save(path)
    assert values(path).tolist() == [[100, 0, -1]]


SPACE = st.sampled_from([b" ", b"\n", b"\t", b"\n# made by hand\n", b"\n#\n# two\n"])


@EXACT
@given(st.data(), st.integers(1, 7), st.integers(1, 7), st.sampled_from([1, 2, 100, 254, 255]), st.booleans())
def test_any_pgm_header_is_read(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject, width: int, height: int, maximum: int, plain: bool
) -> None:
    pixels = data.draw(st.lists(st.integers(0, maximum), min_size=width * height, max_size=width * height))
    magic, a, b = b"P2" if plain else b"P5", data.draw(SPACE), data.draw(SPACE)
    header = magic + b"\n" + a + b"%d" % width + b + b"%d" % height + a + b"%d" % maximum + b"\n"
    body = b" ".join(b"%d" % p for p in pixels) + b"\n" if plain else bytes(pixels)
    path = tmp_path_factory.mktemp("pgm") / "map.pgm"
    path.write_bytes(header + body)
    occupied = 1.0 - np.array(pixels).reshape(height, width)[::-1] / maximum
    expected = np.where(occupied > 0.65, 100, np.where(occupied < 0.196, 0, -1))
    # a maximum other than 255 is rounded to 255 levels
    sure = (abs(occupied - 0.65) > 0.003) & (abs(occupied - 0.196) > 0.003)
    found = values(path)
    assert found.shape == (height, width)
    assert (found == expected)[sure].all()


@EXACT
@given(st.integers(0, 255), st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.booleans())
def test_scale_values_lie_between_free_and_occupied(
    tmp_path_factory: pytest.TempPathFactory, grey: int, one: float, other: float, negate: bool
) -> None:
    free, occupied = sorted((one, other))
    row = grey_row(tmp_path_factory.mktemp("scale"), grey)
    found = int(values(row, "scale", negate, occupied, free)[0, 0])
    share = grey / 255 if negate else 1 - grey / 255
    assert found == (0 if share < free else 100 if share > occupied else found)
    assert 0 <= found <= 100
    trinary = int(values(row, "trinary", negate, occupied, free)[0, 0])
    assert trinary == (0 if share < free else 100 if share > occupied else -1)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"P5",
        b"P5\n4 4\n255\nshort",
        b"P5\n0 0\n255\n",
        b"P2\n2 2\n255\n1 2 three 4\n",
        b"P2\n2 2\n9\n1 2 3 40\n",
        b"no image at all",
    ],
)
def test_unreadable_image_is_one_line_that_names_it(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "broken.pgm"
    path.write_bytes(content)
    with pytest.raises(
        InputFileError, match=r"broken\.pgm: is no image .* allowed: PGM, PNG, BMP, JPEG, GIF, TIFF or WebP$"
    ) as caught:
        values(path)
    assert "\n" not in str(caught.value)


def read_pgm(folder: Path, content: bytes) -> NDArray[np.int8]:
    (folder / "map.pgm").write_bytes(content)
    return values(folder / "map.pgm")


@pytest.mark.parametrize("header", [b"#" + b"x" * 60_000_000 + b"\n", b"#\n" * 30_000_000], ids=["one", "many"])
def test_a_pgm_whose_comments_have_no_end_is_refused_at_once(tmp_path: Path, header: bytes) -> None:
    began = time.process_time()
    with pytest.raises(InputFileError, match="its header does not end within 65536 bytes"):
        read_pgm(tmp_path, b"P5\n" + header + b"2 2\n255\n0000")
    assert time.process_time() - began < 5.0


def test_a_picture_of_one_endless_row_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="has 49000000 x 1 pixels; allowed: 200000 a side"):
        read_pgm(tmp_path, b"P5\n49000000 1\n255\n" + bytes(49_000_000))


def test_a_pgm_with_usual_comments_is_read(tmp_path: Path) -> None:
    content = b"P5\n# CREATOR: GIMP\n#\n 2 #two\n2\n255\n" + bytes([0, 255, 255, 0]) + bytes(70_000)
    assert read_pgm(tmp_path, content).tolist() == [[0, 100], [100, 0]]
