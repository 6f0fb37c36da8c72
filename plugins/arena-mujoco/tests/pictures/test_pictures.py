"""A short episode in 3-D of every robot, drawn by the driver that ``scripts/setup pictures`` installs."""

import numpy as np
import pytest

import arena_core as arena
from arena_mujoco.pictures.command import RenderCommand

pytestmark = pytest.mark.pictures
GOAL, ROBOT = (240, 200, 8), (0, 114, 178)


@pytest.fixture(scope="module", params=["turtlebot3", "jackal", "robotino", "jackal_ackermann"])
def folder(request, tmp_path_factory):
    """Drive one episode on wheels among three people who have legs."""
    where = tmp_path_factory.mktemp(request.param)
    words = [
        "simulator=mujoco",
        "simulator.drive=wheels",
        f"robot={request.param}",
        "planner=dwa",
        "task.pedestrians=3",
    ]
    more = ["pedestrians.body=legs", "episodes=1", "task.time_limit=15", "executor=serial", "localizer=ground_truth"]
    arena.run([*words, *more], where)
    return where


def picture(folder, tmp_path, *words):
    from PIL import Image

    target = tmp_path / "picture.png"
    assert RenderCommand().run([str(folder), "0", "--to", str(target), *words]) == 0
    with Image.open(target) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def near(frame, colour):
    """Return which pixels have about the hue of a colour, whatever light falls on it."""
    shade = frame / np.maximum(frame.max(axis=-1, keepdims=True), 1)
    return (np.abs(shade - np.array(colour) / max(colour)) < 0.12).all(axis=-1)


def test_camera_behind_the_robot_sees_it_in_the_middle(folder, tmp_path):
    frame = picture(folder, tmp_path, "at=1")
    assert frame.shape == (480, 640, 3)
    rows, columns = np.nonzero(near(frame, ROBOT))
    assert len(rows) > 50
    assert abs(np.median(columns) - 320) < 60
    assert abs(np.median(rows) - 240) < 90


def test_camera_above_sees_the_goal(folder, tmp_path):
    assert near(picture(folder, tmp_path, "camera=top", "size=800x800", "at=0"), GOAL).sum() > 20


def test_camera_on_board_does_not_see_the_robot(folder, tmp_path):
    frame = picture(folder, tmp_path, "camera=onboard", "size=320x240", "at=0", "lidar=false")
    assert near(frame[:200], ROBOT).mean() < 0.02
    assert frame.std() > 10  # sky, walls, floor


def test_a_moment_is_drawn_the_same_twice(folder, tmp_path):
    assert np.array_equal(picture(folder, tmp_path, "at=2"), picture(folder, tmp_path, "at=2"))


def test_film_has_as_many_frames_as_asked(folder, tmp_path):
    from imageio_ffmpeg import count_frames_and_secs
    from PIL import Image

    film, moving = tmp_path / "film.mp4", tmp_path / "film.gif"
    RenderCommand().run([str(folder), "--to", str(film), "size=160x120", "until=1", "rate=10"])
    frames, seconds = count_frames_and_secs(str(film))
    assert frames == 11
    assert seconds == pytest.approx(1.1, abs=0.11)
    RenderCommand().run([str(folder), "--to", str(moving), "size=160x120", "until=1", "rate=5"])
    with Image.open(moving) as image:
        assert image.n_frames == 6
