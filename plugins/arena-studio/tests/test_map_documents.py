"""Maps are opened, changed and written so that nothing is lost that no one drew over."""

from __future__ import annotations

import gzip
import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from arena_core import ArenaError, InputFileError
from arena_studio.errors import Conflict, TooLarge
from arena_studio.mapping.map_document import copy_map, map_document, map_files, map_version, save_map
from arena_studio.mapping.transfer import pack_cells, unpack_cells
from arena_studio.project import Project
from arena_worlds.formats.ros_map import load_map

TOP = Path(__file__).resolve().parents[3]
PLACES = (TOP / "tests" / "data" / "maps", TOP.parent / "shared" / "data" / "maps")
MAPS = [yaml for place in PLACES for yaml in sorted(place.rglob("*.yaml")) if "image:" in yaml.read_text()]


def whole(header: dict[str, Any], codes: NDArray[np.uint8], **more: Any) -> tuple[dict[str, Any], bytes]:
    """Return what the page sends when every cell is sent."""
    rectangle = [0, 0, header["width"], header["height"]]
    return {**header, "rectangles": [rectangle], **more}, codes.tobytes()


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def written(project: Project, image: Image.Image | bytes, name: str, **keys: Any) -> str:
    """Write a map with an image and return its path."""
    place = project.root / name
    if isinstance(image, bytes):
        place.write_bytes(image)
    else:
        image.save(place)
    said = {
        "image": name,
        "resolution": 0.1,
        "origin": [0.0, 0.0, 0.0],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.196,
        **keys,
    }
    (project.root / "map.yaml").write_text(
        "\n".join(f"{key}: {json.dumps(value)}" for key, value in said.items()) + "\n"
    )
    return "map.yaml"


@pytest.fixture
def project(tmp_path: Path) -> Project:
    return Project(tmp_path)


@pytest.mark.parametrize("yaml", MAPS, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_map_that_is_opened_and_saved_undrawn_keeps_every_byte(yaml: Path, tmp_path: Path) -> None:
    shutil.copytree(yaml.parent, tmp_path / "maps")
    project = Project(tmp_path)
    (tmp_path / "maps").chmod(0o755)
    before, path = contents(tmp_path / "maps"), f"maps/{yaml.name}"
    header, codes = map_document(project, path)
    assert (np.array(header["values"], np.int8)[codes][::-1] == load_map(yaml).data).all()
    assert save_map(project, path, *whole(header, codes)) == header["version"]
    assert contents(tmp_path / "maps") == before


@pytest.mark.parametrize("yaml", MAPS, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_only_drawn_cells_change_and_they_are_read_as_drawn(yaml: Path, tmp_path: Path) -> None:
    shutil.copytree(yaml.parent, tmp_path / "maps", copy_function=shutil.copyfile)
    (tmp_path / "maps").chmod(0o755)
    project, path = Project(tmp_path), f"maps/{yaml.name}"
    header, codes = map_document(project, path)
    before = load_map(yaml).data
    drawn = codes[1:3, 2:5].copy()
    drawn[:] = header["drawn"]["occupied"]
    save_map(project, path, {**header, "rectangles": [[2, 1, 3, 2]]}, drawn.tobytes())
    after = np.array(before)
    after[::-1][1:3, 2:5] = 100
    assert (load_map(tmp_path / path).data == after).all()


def test_a_stroke_changes_no_other_byte_of_a_pgm(project: Project) -> None:
    comment = b"P5\n# a map of the hall\n4 2\n# up to\n255\n"
    path = written(project, comment + bytes(range(240, 248)) + b"trailing", "hall.pgm")
    header, _ = map_document(project, path)
    save_map(project, path, {**header, "rectangles": [[1, 1, 2, 1]]}, bytes((0, 205)))
    assert (project.root / "hall.pgm").read_bytes() == comment + bytes(
        (240, 241, 242, 243, 244, 0, 205, 247)
    ) + b"trailing"


def test_numbers_of_a_plain_pgm_change_where_they_stand(project: Project) -> None:
    path = written(project, b"P2 3 2 # size\n255\n254 254  12 # row\n\t0 205 7\n", "hall.pgm")
    header, codes = map_document(project, path)
    assert codes.tolist() == [[254, 254, 12], [0, 205, 7]]
    save_map(project, path, {**header, "rectangles": [[0, 1, 2, 1]]}, bytes((254, 205)))
    assert (project.root / "hall.pgm").read_bytes() == b"P2 3 2 # size\n255\n254 254  12 # row\n\t254 205 7\n"


@pytest.mark.parametrize("mode", ["1", "L", "P", "LA", "RGB", "RGBA", "I;16"])
def test_pictures_of_every_mode_keep_mode_and_pixels(mode: str, project: Project) -> None:
    random = np.random.default_rng(0)
    grey = random.choice(np.array((0, 205, 254, 17), np.uint8), (9, 11))
    image = Image.fromarray(grey.astype(np.uint16) * 257) if mode == "I;16" else Image.fromarray(grey).convert(mode)
    path = written(project, image, "hall.png")
    header, _ = map_document(project, path)
    free = header["drawn"]["free"]
    save_map(project, path, {**header, "rectangles": [[4, 5, 1, 1]]}, bytes((free,)))
    with Image.open(project.root / "hall.png") as after:
        assert after.mode == image.mode
        same = np.asarray(after) == np.asarray(image)
    changed = np.argwhere(~(same.all(axis=2) if same.ndim == 3 else same)).tolist()
    assert changed in ([[5, 4]], [])
    assert load_map(project.root / "map.yaml").data[::-1][5, 4] == 0


def test_texts_and_resolution_of_a_png_stay(project: Project) -> None:
    from PIL.PngImagePlugin import PngInfo

    info = PngInfo()
    info.add_text("Author", "the surveyor")
    Image.new("L", (4, 4), 254).save(project.root / "hall.png", pnginfo=info, dpi=(300, 300))
    path = written(project, (project.root / "hall.png").read_bytes(), "hall.png")
    header, _ = map_document(project, path)
    save_map(project, path, {**header, "rectangles": [[0, 0, 1, 1]]}, bytes((0,)))
    with Image.open(project.root / "hall.png") as after:
        assert after.text == {"Author": "the surveyor"}  # type: ignore[attr-defined]
        assert round(after.info["dpi"][0]) == 300


@pytest.mark.parametrize(
    ("mode", "negate", "drawn"),
    [
        ("trinary", 0, {"free": 254, "occupied": 50, "unknown": 205}),
        ("trinary", 1, {"free": 0, "occupied": 254, "unknown": 50}),
        ("raw", 0, {"free": 0, "occupied": 100, "unknown": 254}),
        ("scale", 0, {"free": 254, "occupied": 50, "unknown": None}),
    ],
)
def test_shades_to_draw_with_are_those_that_the_map_reads(
    mode: str, negate: int, drawn: dict[str, int | None], project: Project
) -> None:
    path = written(project, b"P5 2 1 255\n" + bytes((50, 60)), "hall.pgm", mode=mode, negate=negate)
    header, _ = map_document(project, path)
    assert header["drawn"] == drawn


def test_the_commonest_shade_is_drawn_with(project: Project) -> None:
    path = written(project, b"P5 4 1 255\n" + bytes((250, 250, 254, 3)), "hall.pgm")
    assert map_document(project, path)[0]["drawn"] == {"free": 250, "occupied": 3, "unknown": 205}


def test_scale_and_origin_change_in_the_text_and_comments_stay(project: Project) -> None:
    written(project, b"P5 1 1 255\n\0", "hall.pgm")
    text = (
        "# surveyed in May\nimage: hall.pgm\nresolution: 0.050000 # m\norigin: [-10.000000, 1.5, 0.000000]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.15 #0.196\n"
    )
    (project.root / "map.yaml").write_text(text)
    header, _ = map_document(project, "map.yaml")
    save_map(project, "map.yaml", {**header, "resolution": 0.1, "origin": [-10.0, 2.25, 0.0]}, b"")
    changed = text.replace("0.050000 # m", "0.1 # m").replace("[-10.000000, 1.5, 0.000000]", "[-10.0, 2.25, 0.0]")
    assert (project.root / "map.yaml").read_text() == changed


@pytest.mark.parametrize(
    "origin", ["origin:\n  - 1\n  - 2\n  - 0\n", "origin:\n- 1\n- 2\n- 0\n", "origin: [1, 2,\n  0]\n"]
)
def test_origin_may_be_spelled_in_any_way(origin: str, project: Project) -> None:
    written(project, b"P5 1 1 255\n\0", "hall.pgm")
    lines = [
        "image: hall.pgm",
        "resolution: 5e-2",
        "negate: 0",
        *origin.splitlines(),
        "occupied_thresh: 0.65",
        "free_thresh: 0.196",
    ]
    text = "/**:\n  ros__parameters:\n" + "".join(f"    {line}\n" for line in lines)
    (project.root / "map.yaml").write_text(text)
    header, _ = map_document(project, "map.yaml")
    save_map(project, "map.yaml", {**header, "resolution": 1e-7, "origin": [4.0, 5.0, 1.0 / 3.0]}, b"")
    again, _ = map_document(project, "map.yaml")
    assert (again["resolution"], again["origin"]) == (1e-7, [4.0, 5.0, 1.0 / 3.0])


def test_a_map_that_was_changed_elsewhere_is_not_overwritten(project: Project) -> None:
    path = written(project, b"P5 2 1 255\n" + bytes((50, 60)), "hall.pgm")
    header, codes = map_document(project, path)
    save_map(project, path, *whole(header, codes + np.uint8(1)))
    before = contents(project.root)
    with pytest.raises(Conflict, match="changed by someone else"):
        save_map(project, path, *whole(header, codes))
    assert contents(project.root) == before
    assert map_version(project, path) != header["version"]


def test_a_copy_is_a_map_like_the_first_with_another_name(project: Project) -> None:
    path = written(project, b"P5\n# shot\n2 1 255\n" + bytes((50, 60)), "hall.pgm", free_thresh=0.2)
    header, codes = map_document(project, path)
    said = copy_map(project, "sub/copy", {**header, "like": path}, codes.tobytes())
    assert said["path"] == "sub/copy.yaml"
    assert (project.root / "sub" / "copy.pgm").read_bytes() == (project.root / "hall.pgm").read_bytes()
    again, _ = map_document(project, "sub/copy.yaml")
    assert (again["image"], again["free_thresh"], again["version"]) == ("sub/copy.pgm", 0.2, said["version"])
    with pytest.raises(Conflict, match="there already"):
        copy_map(project, "sub/copy", {**header, "like": path}, codes.tobytes())


def test_worlds_of_other_kinds_open_as_grids_and_are_kept_as_new_maps(project: Project) -> None:
    Image.fromarray(np.full((5, 6), 254, np.uint8)).save(project.root / "photo.jpg")
    path = written(project, (project.root / "photo.jpg").read_bytes(), "photo.jpg")
    header, codes = map_document(project, path)
    assert header["version"] is None
    with pytest.raises(InputFileError, match="cannot be changed without loss"):
        save_map(project, path, *whole(header, codes))
    said = copy_map(project, "kept.yaml", header, codes.tobytes())
    assert (load_map(project.root / "kept.yaml").data == 0).all()
    assert said["version"] == map_document(project, "kept.yaml")[0]["version"]


def test_maps_are_listed_and_nothing_else(project: Project) -> None:
    written(project, b"P5 1 1 255\n\0", "hall.pgm")
    (project.root / "curriculum.yaml").write_text("stages: []\n")
    assert map_files(project) == ["map.yaml"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"rectangles": [[0, 0, 9, 1]]}, "inside 2 x 1 cells"),
        ({"rectangles": [[0, 0, 2, 1]], "samples": [[300]]}, "not pixels of this image"),
        ({"rectangles": [[0, 0, 2, 1]], "samples": [[1]]}, "have no sample"),
        ({"rectangles": "all"}, "rectangles"),
        ({"resolution": -1.0}, "resolution"),
        ({"resolution": "wide"}, "resolution"),
        ({"origin": [0.0]}, "origin"),
        ({"origin": [0.0, 0.0, float("inf")]}, "origin"),
    ],
)
def test_what_no_page_would_send_is_refused_and_nothing_is_written(
    change: dict[str, Any], said: str, project: Project
) -> None:
    path = written(project, b"P5 2 1 255\n" + bytes((50, 60)), "hall.pgm")
    header, codes = map_document(project, path)
    before = contents(project.root)
    with pytest.raises(ArenaError, match=said):
        save_map(project, path, {**header, **change}, codes.tobytes())
    assert contents(project.root) == before


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"P5",
        b"P5 9999999 9999999 255\n",
        b"P5 4 4 255\nabc",
        b"P5 0 4 255\n",
        b"\x89PNG\r\n\x1a\nnothing",
        b"GIF89a",
    ],
)
def test_damaged_images_are_told_in_one_line(content: bytes, project: Project) -> None:
    path = written(project, content, "hall.pgm")
    with pytest.raises(ArenaError) as told:
        map_document(project, path)
    assert "\n" not in str(told.value)


def test_image_outside_the_project_is_refused(tmp_path: Path) -> None:
    inside = tmp_path / "inside"
    inside.mkdir()
    project = Project(inside)
    (tmp_path / "secret.pgm").write_bytes(b"P5 1 1 255\n\0")
    path = written(project, b"", "hall.pgm")
    (inside / path).write_text((inside / path).read_text().replace("hall.pgm", "../secret.pgm"))
    with pytest.raises(ArenaError, match="hidden parts"):
        map_document(project, path)


def test_bodies_travel_with_and_without_gzip() -> None:
    body = pack_cells({"a": 1}, b"cells")
    assert unpack_cells(body) == unpack_cells(gzip.compress(body)) == ({"a": 1}, b"cells")


@pytest.mark.parametrize(
    "body", [b"", b"abc", b"\xff\xff\xff\xff", b"\x02\0\0\0[]", b"\x01\0\0\0{", b"\x1f\x8bnothing"]
)
def test_bodies_that_are_none_are_refused(body: bytes) -> None:
    with pytest.raises(InputFileError):
        unpack_cells(body)


def test_a_body_that_unpacks_without_end_is_refused() -> None:
    with pytest.raises(TooLarge):
        unpack_cells(gzip.compress(bytes(60_000_000), 1))
