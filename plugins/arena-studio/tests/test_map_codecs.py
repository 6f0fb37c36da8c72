"""Images and YAML texts that are written again say what was said, whatever their spelling."""

from __future__ import annotations

import io

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from PIL import Image

from arena_core import InputFileError
from arena_studio.mapping.picture import read_picture
from arena_studio.mapping.pnm import read_pnm
from arena_studio.mapping.yaml_text import with_values

QUICK = settings(derandomize=True, deadline=None, max_examples=60)
SHAPES = st.tuples(st.integers(1, 6), st.integers(1, 6))
GAPS = st.sampled_from([b" ", b"\n", b"\t", b" # a remark\n", b"\n\n"])
NUMBERS = st.floats(allow_nan=False, allow_infinity=False)


@st.composite
def pnm_files(draw: st.DrawFn) -> tuple[bytes, np.ndarray]:
    """Return a PGM or PPM in any spelling, and its samples."""
    kind, highest = (
        draw(st.sampled_from([b"P2", b"P3", b"P5", b"P6"])),
        draw(st.sampled_from([1, 100, 255, 256, 65535])),
    )
    shape = (*draw(SHAPES), 3 if kind in (b"P3", b"P6") else 1)
    samples = draw(arrays.arrays(np.uint16, shape, elements=st.integers(0, highest)))
    rows, columns = shape[:2]
    header = b"".join([kind, draw(GAPS), b"%d" % columns, draw(GAPS), b"%d" % rows, draw(GAPS), b"%d" % highest, b"\n"])
    if kind in (b"P5", b"P6"):
        return header + samples.astype(">u2" if highest > 255 else np.uint8).tobytes() + draw(
            st.binary(max_size=3)
        ), samples
    return header + b"".join(b"%d" % value + draw(GAPS) for value in samples.ravel().tolist()), samples


@QUICK
@given(pnm_files(), st.data())
def test_pnm_files_keep_every_byte_but_those_of_changed_pixels(
    file: tuple[bytes, np.ndarray], data: st.DataObject
) -> None:
    content, samples = file
    image = read_pnm(content, "hall.pgm")
    assert (image.samples == samples).all()
    assert image.encode_samples(image.samples) == content
    changed = data.draw(arrays.arrays(np.uint16, samples.shape, elements=st.integers(0, image.highest))).astype(
        image.samples.dtype
    )
    again = read_pnm(image.encode_samples(changed), "hall.pgm")
    assert (again.samples == changed).all()
    assert image.encode_samples(changed).startswith(content[: image.begin])


@QUICK
@given(pnm_files())
def test_pnm_files_of_another_size_are_read_back(file: tuple[bytes, np.ndarray]) -> None:
    image = read_pnm(file[0], "hall.pgm")
    wider = np.concatenate([image.samples, image.samples], axis=1)
    assert (read_pnm(image.encode_samples(wider), "hall.pgm").samples == wider).all()


@QUICK
@given(pnm_files(), st.data())
def test_pnm_files_that_end_too_early_are_refused(file: tuple[bytes, np.ndarray], data: st.DataObject) -> None:
    content, samples = file
    cut = read_pnm(content, "hall.pgm").begin + (samples.size - 1 if content[:2] in (b"P5", b"P6") else 0)
    with pytest.raises(InputFileError, match="is no image that can be read"):
        read_pnm(content[: data.draw(st.integers(0, cut))], "hall.pgm")


@QUICK
@given(st.data(), st.sampled_from(["1", "L", "P", "LA", "RGB", "RGBA", "I;16"]), st.sampled_from(["PNG", "BMP"]))
def test_pictures_are_read_back(data: st.DataObject, mode: str, form: str) -> None:
    if form == "BMP" and mode in ("LA", "I;16", "RGBA"):
        return
    rows, columns = data.draw(SHAPES)
    first = Image.new(mode, (columns, rows))
    if mode == "P":
        first.putpalette([value for grey in range(7) for value in (grey * 40,) * 3])
    content = io.BytesIO()
    first.save(content, form)
    image = read_picture(content.getvalue(), "hall.png")
    assert image is not None
    shape = (rows, columns, image.samples.shape[2])
    samples = data.draw(
        arrays.arrays(
            np.uint16, shape, elements=st.integers(0, min(image.highest, 6) if mode == "P" else image.highest)
        )
    )
    again = read_picture(image.encode_samples(samples.astype(image.samples.dtype)), "hall.png")
    assert again is not None
    assert again.image.mode == mode
    assert (again.samples == samples).all()


@QUICK
@given(
    NUMBERS,
    st.lists(NUMBERS, min_size=3, max_size=3),
    st.sampled_from(["[1, 2.50, 3]", "\n- 1\n- 2.50\n- 3", "[ 1,2.50,\n  3 ]  # corner"]),
)
def test_numbers_are_read_back_exactly_and_all_else_stays(resolution: float, origin: list[float], spelled: str) -> None:
    text = f"# a hall\nresolution: 5e-2   # m\nname: 'ä # no remark'\norigin: {spelled}\nlast: 1"
    changed = with_values(text, {"resolution": resolution, "origin": origin}, "map.yaml")
    read = yaml.safe_load(changed)
    assert (read["resolution"], read["origin"], read["name"], read["last"]) == (resolution, origin, "ä # no remark", 1)
    assert changed.startswith("# a hall\nresolution: ")
    assert "   # m\nname: 'ä # no remark'\norigin: " in changed
    assert ("# corner" in changed) == ("# corner" in spelled)


@pytest.mark.parametrize(
    "text", ["", "[", "- 1", "origin: 3\nresolution: 1", "origin: [1, 2]\nresolution: 1", "resolution: 1"]
)
def test_texts_without_the_keys_are_refused(text: str) -> None:
    with pytest.raises(InputFileError, match=r"map\.yaml: .*allowed: a map's YAML file"):
        with_values(text, {"origin": [1.0, 2.0, 3.0], "resolution": 1.0}, "map.yaml")
