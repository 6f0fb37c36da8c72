import json
import sys

import gymnasium
import numpy as np
import pytest

import arena_gym.envs  # noqa: F401 - registers the environments
from arena_core import ArenaError
from arena_drawing import frames
from arena_gym.environment import NavigationEnv
from arena_gym.vector_environment import NavigationVectorEnv

SMALL = [
    "world=empty",
    "world.width=8",
    "world.height=8",
    "task.pedestrians=3",
    "environment.worlds=2",
    "environment.problems_per_world=2",
]


def test_rgb_arrays_show_each_step_and_gymnasium_is_content():
    env = gymnasium.make("arena/Navigation-v0", overrides=SMALL, render_mode="rgb_array")
    env.reset(seed=0)
    first = env.render()
    assert (first.dtype, first.ndim, first.shape[2]) == (np.uint8, 3, 3)
    assert np.array_equal(env.render(), first)
    env.step(np.array([1.0, 0.0], np.float32))
    assert not np.array_equal(env.render(), first)
    env.reset(seed=1)
    assert not np.array_equal(env.render(), first)
    env.close()


def test_pictures_change_nothing():
    drawn, plain = (NavigationEnv(overrides=SMALL, render_mode=mode) for mode in ("rgb_array", None))
    seen = []
    for env in (drawn, plain):
        rows = [env.reset(seed=3)[0]]
        for _ in range(5):
            rows.append(env.step(np.array([0.5, 0.2], np.float32))[0])
            if env is drawn:
                env.render()
        seen.append(np.array(rows))
    assert np.array_equal(*seen)


def test_each_world_of_a_vector_has_its_picture():
    env = NavigationVectorEnv(2, overrides=SMALL, render_mode="rgb_array")
    env.reset(seed=0)
    frames = env.render()
    assert len(frames) == 2
    single = NavigationEnv(overrides=SMALL, render_mode="rgb_array")
    single.reset(seed=1)
    assert np.array_equal(frames[1], single.render())
    env.close()


def test_a_door_is_filled_until_it_opens(tmp_path):
    leaf = [[4.0, 2.0], [4.2, 2.0], [4.2, 4.0], [4.0, 4.0]]
    problem = {"name": "door", "start": [1, 3], "goal": [7, 3], "doors": [{"vertices": leaf, "open": [[0.25]]}]}
    path = tmp_path / "door.json"
    path.write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": [problem]}))
    words = ["task=scenario", f"task.path={path}", "environment.worlds=1", "environment.problems_per_world=1"]
    env = NavigationEnv(overrides=[*SMALL[:3], *words], render_mode="rgb_array")
    env.reset(seed=0)
    brown = []
    for _ in range(4):
        env.step(np.zeros(2, np.float32))
        brown.append(int((np.abs(env.render().astype(int) - (0x6D, 0x4C, 0x41)).max(axis=2) < 12).sum()))
    assert min(brown[:2]) > 2 * max(brown[2:]) > 0


def test_what_cannot_be_shown_is_said_at_once():
    with pytest.raises(ArenaError, match=r"render_mode is ansi; allowed: human, rgb_array, or none"):
        NavigationEnv(overrides=SMALL, render_mode="ansi")
    with pytest.raises(ArenaError, match="there is no display; allowed here: rgb_array"):
        NavigationEnv(overrides=SMALL, render_mode="human")
    env = NavigationEnv(overrides=SMALL, render_mode="rgb_array")
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.render()


@pytest.mark.parametrize(
    ("here", "modes"),
    [("a display", ["human", "rgb_array"]), ("no display", ["rgb_array"]), ("no drawing", [])],
    ids=lambda value: str(value),
)
def test_an_environment_offers_the_modes_that_are_possible_here(monkeypatch, here, modes):
    if here == "no drawing":
        monkeypatch.setitem(sys.modules, "arena_drawing.frames", None)
    else:
        monkeypatch.setattr(frames, "has_display", lambda: here == "a display")
    env = NavigationEnv(overrides=SMALL)
    assert env.metadata == {"render_modes": modes, "render_fps": 10}
    assert NavigationEnv.metadata["render_modes"] == ["human", "rgb_array"]
