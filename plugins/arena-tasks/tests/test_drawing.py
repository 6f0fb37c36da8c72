"""`arena scenario draw` makes a picture of a file without a browser."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from arena_core import PedestrianSpec
from arena_core.cli.main import main
from arena_tasks.scenario_files.zones import zones_of

DATA = Path(__file__).parents[3] / "tests" / "data"
WORLD = ["world=empty", "world.width=12", "world.height=8"]
PERSON, WALL = (0xD5, 0x5E, 0x00), (92, 92, 97)


def scenes(path: Path, count: int, **changes: object) -> Path:
    problems = [{"name": f"scene{k}", "start": [1, 1], "goal": [9, 6], **changes} for k in range(count)]
    path.write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": problems}))
    return path


def pixels(path: Path) -> np.ndarray:
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def share(image: np.ndarray, colour: tuple[int, int, int]) -> float:
    return float((np.abs(image - colour).max(axis=-1) < 8).mean())


@pytest.mark.parametrize("name", ["hall_obs03", "hall_vehicles"])
def test_a_file_of_arena_tools_is_drawn_on_the_map_that_it_names(tmp_path: Path, capsys, name: str) -> None:
    target = tmp_path / "hall.png"
    assert (
        main(
            [
                "scenario",
                "draw",
                str(DATA / "scenarios" / f"{name}.json"),
                "--to",
                str(target),
                f"world.maps={DATA / 'maps'}",
            ]
        )
        == 0
    )
    assert f"written: {target}" in capsys.readouterr().out
    image = pixels(target)
    assert share(image, WALL) > 0.03
    assert share(image, PERSON) > 0.004


def test_scene_chooses_one_and_without_it_all_are_beside_each_other(tmp_path: Path) -> None:
    path = scenes(tmp_path / "s.json", 4)
    assert main(["scenario", "draw", str(path), "--to", str(tmp_path / "all.png"), *WORLD]) == 0
    assert main(["scenario", "draw", str(path), "--to", str(tmp_path / "one.png"), "scene=3", *WORLD]) == 0
    assert pixels(tmp_path / "all.png").shape[1] > 1.1 * pixels(tmp_path / "one.png").shape[1]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["scene=13"], "scene is 13; allowed, in"),
        ([], "holds 13 scenes; allowed in one picture: 12"),
        (["--to", "a.jpg"], "out is a.jpg; allowed: a name that ends in .png"),
        (["scene=x"], "scene is 'x'"),
    ],
)
def test_what_cannot_be_drawn_is_one_line(tmp_path: Path, capsys, words: list[str], said: str) -> None:
    assert main(["scenario", "draw", str(scenes(tmp_path / "s.json", 13)), *words, *WORLD]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_a_crowded_scene_is_drawn(tmp_path: Path) -> None:
    zone = {
        "start_up_mode": "trigger_zone",
        "trigger_zone_radius": 2.0,
        "trigger_zone_2_x": 8.0,
        "trigger_zone_2_radius": 1.0,
    }
    people = [
        {"position": [5, 5], "waypoints": [[5, 2], [7, 2]], "behaviour": {"type": "child", "group": "a"}},
        {"position": [4, 5], "behaviour": zone},
    ]
    things = {"obstacles": [{"center": [3, 3], "radius": 0.4}], "furniture": [{"kind": "table", "pose": [6, 6, 0.5]}]}
    path = scenes(tmp_path / "s.json", 1, pedestrians=people, **things)
    assert main(["scenario", "draw", str(path), "--to", str(tmp_path / "s.png"), *WORLD]) == 0


def test_trigger_zones_lie_around_the_person_unless_said_otherwise() -> None:
    where = {"trigger_zone_radius": 2.0, "trigger_zone_2_x": 8.0, "trigger_zone_2_radius": 1.0, "trigger_zone_3_x": 4.0}
    person = PedestrianSpec(
        0, np.array((1.0, 2.0)), np.empty((0, 2)), 0.3, 0.3, {"start_up_mode": "trigger_zone", **where}
    )
    assert zones_of(person) == [(1.0, 2.0, 2.0), (8.0, 2.0, 1.0)]
    assert zones_of(PedestrianSpec(0, person.position_xy, person.waypoints_xy, 0.3, 0.3, where)) == []


@pytest.mark.parametrize("world", [WORLD, ["world=empty", "world.width=4", "world.height=14"]], ids=["wide", "narrow"])
def test_legend_is_whole_however_many_groups_there_are_and_however_they_are_called(
    tmp_path: Path, world: list[str]
) -> None:
    people = [
        {
            "position": [2.0, 2.0 + 0.5 * k],
            "behaviour": {"group": name, "trigger_zone_radius": 1.0, "start_up_mode": "trigger_zone"},
        }
        for k, name in enumerate(
            ("visitors of the second hall", "porters", "x" * 60, "nurses", "guests", "children of the school")
        )
    ]
    path = scenes(
        tmp_path / "s.json",
        1,
        pedestrians=people,
        start=[1, 1],
        goal=[3, 6],
        obstacles=[{"center": [3, 3], "radius": 0.2}],
    )
    assert main(["scenario", "draw", str(path), "--to", str(tmp_path / "a.png"), *world]) == 0
    image = pixels(tmp_path / "a.png")
    framed = np.flatnonzero((image[:, 20:-20] < 60).all(axis=-1).mean(axis=1) > 0.9)  # the scene's frame, black
    below = image[framed[-1] + 3 :] if len(framed) else image[-60:]
    assert (below < 200).any(), "there is a legend"
    assert (below[:, [0, 1, 2, -3, -2, -1]] > 250).all(), "and nothing of it is cut off at the sides"
    assert (image[-2:] > 250).all()
