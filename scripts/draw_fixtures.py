#!/usr/bin/env python3
"""Draw the small maps, scenarios, worlds, recordings and grids that tests read: all our own, so that a checkout needs
no other data.

usage: .venv/bin/python scripts/draw_fixtures.py [FOLDER]      (FOLDER is tests/data)
"""

from __future__ import annotations

import gzip
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

MAP = (
    "image: {image}\nresolution: {resolution}\norigin: [{origin}]\nnegate: "
    "0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
)
WALL, FREE, UNKNOWN = 0, 254, 205  # grey values of a ROS map
LETTER = """\
..........
.######...
.#........
.#........
.#####....
.#........
.#........
.#......#.
........#.
.....####."""
PLACES = ((2.0, 2.0), (10.0, 2.0), (10.0, 6.0), (2.0, 6.0))  # m, in the hall, between its walls and its pillar
MODELS = {"adult": "person_two_legged", "vehicle": "big_forklift"}  # as arena-tools names them
AGENT = {
    "start_up_mode": "default",
    "wait_time": 0.0,
    "trigger_zone_radius": 0.0,
    "chatting_probability": 0.01,
    "tell_story_probability": 0.0,
    "group_talking_probability": 0.01,
    "talking_and_walking_probability": 0.01,
    "requesting_service_probability": 0.0,
    "requesting_guide_probability": 0.0,
    "requesting_follower_probability": 0.0,
    "max_talking_distance": 5.0,
    "max_servicing_radius": 5.0,
    "talking_base_time": 10.0,
    "tell_story_base_time": 0.0,
    "group_talking_base_time": 10.0,
    "talking_and_walking_base_time": 6.0,
    "receiving_service_base_time": 20.0,
    "requesting_service_base_time": 30.0,
    "force_factor_desired": 1.0,
    "force_factor_obstacle": 1.0,
    "force_factor_social": 5.0,
    "force_factor_robot": 0.0,
}
POST = """<model name='post_{k}'><static>1</static><pose frame=''>{x:.3f} {y:.3f} 0 0 0 0</pose>
<link name='link'><collision name='collision'>
<geometry><cylinder><radius>0.075</radius><length>1</length></cylinder></geometry></collision></link>
</model>
"""
CELL, CELL_X, CELL_Y = 0.15, -4.575, 5.075  # m, the grid of BARN's posts, and the middle of its cell (0, 0)


def main(folder: Path) -> None:
    """Write all of them."""
    draw_maps(folder / "maps")
    draw_scenarios(folder / "scenarios")
    draw_barn(folder / "barn")
    draw_recordings(folder / "pedestrians")
    draw_grid(folder / "movingai")


def draw_maps(folder: Path) -> None:
    """Write a hall with a pillar as a ROS map, a letter as three kinds of picture, and a
    Flatland world of one layer.
    """
    hall = np.full((80, 120), FREE, np.uint8)
    hall[[0, 1, -2, -1]] = hall[:, [0, 1, -2, -1]] = WALL
    hall[35:45, 56:64] = WALL
    hall[2:10, -10:-2] = UNKNOWN
    save_picture(folder / "hall", "map.pgm", hall)
    write_text(folder / "hall" / "map.yaml", MAP.format(image="map.pgm", resolution=0.1, origin="0.0, 0.0, 0.0"))

    letter = np.array([[WALL if cell == "#" else FREE for cell in row] for row in LETTER.splitlines()], np.uint8)
    for ending in ("png", "pgm", "bmp"):
        save_picture(folder / "letter", f"letter.{ending}", letter)
    write_text(
        folder / "letter" / "letter.yaml", MAP.format(image="letter.png", resolution=0.1, origin="2.0, 3.0, 1.0")
    )

    save_picture(folder / "flatland", "walls.png", letter)
    write_text(
        folder / "flatland" / "map.yaml", MAP.format(image="walls.png", resolution=0.25, origin="-1.0, -1.0, 0.0")
    )
    write_text(
        folder / "flatland" / "map.world.yaml",
        "properties: {velocity_iterations: 10}\nlayers:\n- {name: static, map: map.yaml}\n",
    )


def draw_scenarios(folder: Path) -> None:
    """Write two scenarios of the hall in the format of arena-tools: among walkers, and among forklifts that wait."""
    for name, kind, speed, rounds in (("hall_obs03", "adult", 0.3, 30), ("hall_vehicles", "vehicle", 1.0, 1)):
        agents = [scenario_agent(k, kind, speed) for k in range(3)]
        content = {
            "pedsim_agents": agents,
            "static_obstacles": [],
            "interactive_obstacles": [],
            "robot_position": [1.0, 4.0],
            "robot_goal": [11.0, 4.0],
            "resets": rounds,
            "map_path": "/home/somebody/maps/hall/map.yaml",
            "format": "arena-tools",
        }
        write_text(folder / f"{name}.json", json.dumps(content, indent=2) + "\n")


def scenario_agent(number: int, kind: str, speed: float) -> dict[str, Any]:
    """Return a person who walks round the pillar from corner to corner."""
    ways = [list(PLACES[(number + k) % len(PLACES)]) for k in range(1, 4)]
    head = {"name": str(number + 1), "id": 0, "pos": list(PLACES[number]), "type": kind}
    body = {"yaml_file": f"/home/somebody/models/{MODELS[kind]}.model.yaml", "number_of_peds": 1, "vmax": speed}
    return {**head, **body, **AGENT, "waypoints": ways, "waypoint_mode": 0}


def draw_barn(folder: Path) -> None:
    """Write two worlds as the BARN challenge has them: posts on a grid, closed on three sides, and a path
    of cells between the posts.
    """
    random = np.random.default_rng(7)
    (folder / "path_files").mkdir(parents=True, exist_ok=True)
    (folder / "world_files").mkdir(parents=True, exist_ok=True)
    for number in range(2):
        column = np.clip(np.cumsum(random.integers(-1, 2, 30)) + 14, 8, 21)
        way = np.stack((column, np.arange(30)), axis=1)
        posts = [
            (CELL_X + CELL * c, CELL_Y + CELL * r)
            for c in range(30)
            for r in range(30)
            if free_of(way, c, r) and random.random() < 0.2
        ]
        posts += wall_posts()
        models = "".join(POST.format(k=k, x=x, y=y) for k, (x, y) in enumerate(posts))
        world = f"<sdf version='1.6'>\n<world name='default'>\n{models}</world>\n</sdf>\n"
        (folder / "world_files" / f"world_{number}.world.gz").write_bytes(gzip.compress(world.encode(), mtime=0))
        np.save(folder / "path_files" / f"path_{number}.npy", way)


def free_of(way: NDArray[np.int64], column: int, row: int) -> bool:
    """Return whether a post there leaves half a metre to every cell of the way."""
    return bool(np.hypot(*(way - (column, row)).T).min() * CELL > 0.5)


def wall_posts() -> list[tuple[float, float]]:
    """Return the posts of the wall on the left, on the right and below, where the robot starts."""
    sides = [(x, 0.075 + CELL * k) for x in (CELL_X + CELL, CELL_X + 30 * CELL) for k in range(34)]
    return [*sides, *((CELL_X + CELL * k, 0.075) for k in range(2, 30))]


def draw_recordings(folder: Path) -> None:
    """Write people who cross a street (as UCY's obsmat, 25 frames/s, every tenth kept) and who walk a
    corridor (as Juelich's, cm).
    """
    random = np.random.default_rng(11)
    rows = [row for person in range(1, 25) for row in crossing_track(person, random)]
    lines = (" ".join(f"{value:.6g}" for value in row) for row in sorted(rows, key=lambda row: (row[0], row[1])))
    write_text(folder / "street" / "obsmat.txt", "\n".join(lines) + "\n")
    walk = [
        (person, 20 * person + k, 90.0 + 5 * person, 600.0 - 8.25 * k, 175.0)
        for person in range(1, 9)
        for k in range(60)
    ]
    write_text(
        folder / "corridor" / "uo-corridor.txt", "".join(f"{p} {f} {x:g} {y:g} {z:g}\n" for p, f, x, y, z in walk)
    )


def crossing_track(person: int, random: np.random.Generator) -> list[tuple[float, ...]]:
    """Return rows of frame, person, x, 0, y, and their velocity: a straight way of 12 m, now to
    the left, now to the right.
    """
    speed = random.uniform(0.9, 1.5) * (-1) ** person
    begin, y = 1 + 10 * int(random.integers(0, 130)), random.uniform(2.0, 18.0)
    steps = range(int(12.0 / abs(speed) / 0.4))
    x = 6.0 if speed < 0 else -6.0
    return [(begin + 10.0 * k, person, x + 0.4 * k * speed, 0.0, y, speed, 0.0, 0.0) for k in steps]


def draw_grid(folder: Path) -> None:
    """Write a grid of rooms and ways through it as MovingAI has them, their lengths from scipy's search."""
    free = np.ones((24, 32), bool)
    free[:, 8::8] = free[8::8] = False
    free[[3, 11, 20], 8] = free[[5, 12, 19], 16] = free[[2, 13, 21], 24] = True
    free[8, [4, 20]] = free[16, [11, 27]] = True
    picture = "\n".join("".join("." if cell else "@" for cell in row) for row in free)
    write_text(folder / "rooms.map", f"type octile\nheight {free.shape[0]}\nwidth {free.shape[1]}\nmap\n{picture}\n")
    random = np.random.default_rng(3)
    cells = np.argwhere(free)
    pairs = [tuple(cells[k] for k in random.choice(len(cells), 2, replace=False)) for _ in range(30)]
    lengths = dijkstra(octile_moves(free), indices=[at[0] * free.shape[1] + at[1] for at, _ in pairs])
    lines = [scenario_line(*pair, free, ways) for pair, ways in zip(pairs, lengths, strict=True)]
    write_text(
        folder / "rooms.map.scen", "version 1\n" + "".join(sorted(lines, key=lambda line: float(line.split()[-1])))
    )


def scenario_line(start: Any, goal: Any, free: NDArray[np.bool_], ways: NDArray[np.float64]) -> str:
    """Return a line of a .scen file: bucket, map, its size, start and goal as x y, and the
    length of the shortest way.
    """
    length = ways[goal[0] * free.shape[1] + goal[1]]
    numbers = (free.shape[1], free.shape[0], start[1], start[0], goal[1], goal[0])
    return "\t".join((str(int(length // 4)), "rooms.map", *map(str, numbers), f"{length:.8f}")) + "\n"


def octile_moves(free: NDArray[np.bool_]) -> csr_array:
    """Return the octile moves between free cells, none of which cuts a corner."""
    rows, columns = free.shape
    found: list[tuple[int, int, float]] = []
    for row, column in np.argwhere(free):
        for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
            r, c = row + down, column + right
            if r < rows and 0 <= c < columns and free[r, c] and free[row, c] and free[r, column]:
                found.append((row * columns + column, r * columns + c, float(np.hypot(down, right))))
    begin, end, length = zip(*found, strict=True)
    one_way = csr_array((length, (begin, end)), shape=(free.size, free.size))
    return one_way + one_way.T


def save_picture(folder: Path, name: str, grey: NDArray[np.uint8]) -> None:
    """Write a picture."""
    folder.mkdir(parents=True, exist_ok=True)
    Image.fromarray(grey).save(folder / name)


def write_text(path: Path, content: str) -> None:
    """Write a text."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(content)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).resolve().parents[1] / "tests" / "data"))
