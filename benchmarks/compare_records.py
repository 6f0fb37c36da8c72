"""Run the same short runs in two checkouts on one machine and compare their records, array by array.

usage: .venv/bin/python benchmarks/compare_records.py BEFORE [AFTER] [--only NAME ...] [--except config ...] [--keep
FOLDER]

Each checkout (AFTER: this one) runs with the interpreter of its own .venv. Arrays and meta must be equal bit for bit;
what names the code, and times, do not count. Exit status: 0 all equal, 1 some differ or failed, 2 the request was
wrong.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parents[1]
ALWAYS = ["executor=serial", "report=false"]
SINCE = ("route_points", "route_offsets")  # arrays that records of older checkouts lack
CODE = ("columns.code", "columns.config_hash")  # what says which code and configuration made a record
POST = """<model name='post{k}'><static>1</static><pose>{x} {y} 0 0 0 0</pose><link name='link'>
<collision name='collision'><geometry><cylinder><radius>0.075</radius><length>1</length></cylinder></geometry>
</collision></link></model>"""
BARN_WORLD = "barn/world_7.world"  # a row of posts across the straight way, written below the folder of the runs
# the cheapest drive there is, for what the people do
WALK = "planner=pure_pursuit localizer=ground_truth tracker=none episodes=1"

# By name: overrides, NEW|OLD where a key was renamed. Together: every planner, robot, task, crowd, localiser, tracker,
# and most presets.
RUNS: Mapping[str, str] = {
    "dwa": "planner=dwa robot=turtlebot3 task.pedestrians=8 episodes=2 task.time_limit=15",
    "dwa_as_released": "planner=dwa_as_released robot=jackal localizer=amcl_as_ros world=indoor_as_released episodes=2 "
    "task.time_limit=12",
    "dwa_as_released_ackermann": "planner=dwa_as_released robot=jackal_ackermann localizer=ground_truth episodes=1 "
    "task.time_limit=10",
    "dwa_lively": "planner=dwa robot=robotino world=outdoor people=lifelike pedestrians=social_force_lively "
    "localizer=amcl_as_clearpath"
    " tracker=kalman_legs episodes=2 task.time_limit=12",
    "teb": "planner=teb robot=jackal localizer=odometry waypoints=subsample pedestrians=orca people=lifelike "
    "episodes=2 task.time_limit=12",
    "teb_as_released": "planner=teb_as_released robot=robotino pedestrians=social_force_as_released episodes=1 "
    "task.time_limit=10",
    "mpc": "planner=mpc robot=robotino localizer=ground_truth episodes=2 task.time_limit=8",
    "mpc_as_released": "planner=mpc_as_released robot=jackal localizer=ground_truth episodes=1 task.time_limit=8",
    "mpc_quadratic": "planner=mpc_quadratic robot=jackal_ackermann localizer=ground_truth episodes=1 task.time_limit=6",
    "mppi": "planner=mppi robot=jackal_ackermann localizer=ground_truth episodes=1 task.time_limit=8",
    "mppi_as_nav2": "planner=mppi_as_nav2 robot=turtlebot3 localizer=ground_truth episodes=1 task.time_limit=8",
    "orca": "planner=orca robot=robotino pedestrians=replay world=empty episodes=2 task.time_limit=12",
    "orca_latency": "planner=orca robot=jackal pedestrians=none task.obstacles.count=4|task.obstacles=4 "
    "timing.mode=latency"
    " timing.latency=0.2 recording.scans=true replan.period=1.0 episodes=2 task.time_limit=10",
    "cadrl": "planner=cadrl robot=jackal world=indoor_as_released task.pedestrians=6 episodes=1 task.time_limit=12",
    "sarl": "planner=sarl robot=robotino people=lifelike episodes=1 task.time_limit=12",
    "rosnav": "planner=rosnav robot=turtlebot3 people=lifelike episodes=2 task.time_limit=12",
    "gring": "planner=gring robot=jackal global_planner=ompl world=rooms episodes=1 task.time_limit=10",
    "navrep": "planner=navrep robot=robotino world=mixed episodes=1 task.time_limit=10",
    "navrep_v_only": "planner=navrep_v_only robot=turtlebot3 episodes=1 task.time_limit=10",
    "aio": "planner=aio robot=turtlebot3 task.pedestrians=8 episodes=2 task.time_limit=10",
    "staged": "planner=pure_pursuit robot=turtlebot3 task=staged people=lifelike task.block=2 episodes=3 "
    "task.random.time_limit=10",
    "barn": f"planner=dwa experiment=barn world.path={BARN_WORLD} episodes=1 task.time_limit=15",
    "dynabarn": "planner=mpc experiment=dynabarn episodes=1 task.time_limit=8",
    "blind_corner": "planner=teb robot=turtlebot3 scenario=arena/blind_corner_high localizer=ground_truth episodes=1 "
    "task.time_limit=15",
    "queue": f"{WALK} scenario=arena/queue_high pedestrians=social_force_lively task.time_limit=60",
    "many_lively": f"{WALK} scenario=arena/warehouse_20 pedestrians=social_force_lively people=lifelike "
    "task.time_limit=60",
    "many_yielding": f"{WALK} scenario=arena/doorway_high pedestrians=social_force pedestrians.reaction=yield "
    "task.time_limit=40",
    "many_released": f"{WALK} scenario=arena/indoor_20 pedestrians=social_force_as_released task.time_limit=40",
    "many_orca": f"{WALK} scenario=arena/outdoor_20 pedestrians=orca pedestrians.reaction=yield task.time_limit=40",
    "mujoco": "planner=dwa robot=jackal simulator=mujoco task.pedestrians=12 pedestrians.body=legs episodes=2 "
    "task.time_limit=15",
    "mujoco_wheels": "planner=teb robot=turtlebot3 simulator=mujoco simulator.drive=wheels "
    "task.pedestrians=12 episodes=2"
    " task.time_limit=15",
    "respawning": f"{WALK} people=lifelike task.people.respawn=true|task.respawn=true task.pedestrians=15 "
    "task.time_limit=60",
}

POOL = ["task.time_limit=8", "environment.worlds=2", "environment.problems_per_world=4"]

# By name: what is trained in (the environment's arguments), and how many worlds and steps.
TRAININGS: Mapping[str, tuple[dict[str, Any], int, int]] = {
    "training": ({"robot": "jackal", "overrides": POOL}, 8, 120),
    "training_noisy": (
        {
            "robot": "turtlebot3",
            "reward": "gring",
            "observation": "gring",
            "overrides": [
                *POOL,
                "people=lifelike",
                "environment.collisions_to_end=null",
                "randomization.lidar_noise.high=0.05",
                "randomization.latency.high=3",
                "randomization.people={low: 0, high: 5}",
            ],
        },
        4,
        100,
    ),
    "training_switch": ({"robot": "turtlebot3", "observation": "aio", "overrides": [*POOL, "switch=aio"]}, 2, 15),
}


def main(words: Sequence[str]) -> int:
    """Run what is asked for in both checkouts, print the table and return the exit status."""
    parser = argparse.ArgumentParser(
        "compare_records", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("before", type=Path, help="a checkout with its .venv")
    parser.add_argument("after", type=Path, nargs="?", default=HERE, help="another one")
    parser.add_argument(
        "--only", nargs="+", default=[*RUNS, *TRAININGS], metavar="NAME", help=", ".join([*RUNS, *TRAININGS])
    )
    parser.add_argument(
        "--except", nargs="+", default=[], metavar="KEY", dest="ignored", help="parts of meta that may differ: config"
    )
    parser.add_argument(
        "--keep", type=Path, help="a folder for the runs, where earlier ones of the same name count as run"
    )
    given = parser.parse_args(words)
    for checkout in (given.before, given.after):
        if not _python_path(checkout).exists():
            parser.error(f"{checkout} has no .venv; allowed: a checkout after make setup")
    if unknown := [name for name in given.only if name not in RUNS and name not in TRAININGS]:
        parser.error(f"there is no run {', '.join(unknown)}; allowed: {', '.join([*RUNS, *TRAININGS])}")
    with tempfile.TemporaryDirectory() as temporary:
        root = (given.keep or Path(temporary)).resolve()
        folders = [root / "before", root / "after"]
        for checkout, folder in zip((given.before, given.after), folders, strict=True):
            _run_checkout(checkout.resolve(), folder, given.only)
        return _print_table(
            {name: compare_runs(*(folder / name for folder in folders), given.ignored) for name in given.only}
        )


def compare_runs(before: Path, after: Path, ignored: Iterable[str] = ()) -> tuple[int, str]:
    """Return how many episodes two folders have in common, and their first difference; empty where there is none.

    ``ignored`` are parts of meta that may differ, as words joined by dots.
    """
    names = [
        sorted(path.relative_to(folder).as_posix() for path in folder.glob("records/**/*.npz"))
        for folder in (before, after)
    ]
    if names[0] != names[1]:
        return 0, f"records: {_short_repr(names[0])}, then {_short_repr(names[1])}"
    if not names[0]:
        return 0, "neither has a record"
    for name in names[0]:
        if difference := compare_records(_read_arrays(before / name), _read_arrays(after / name), ignored):
            return len(names[0]), f"{name}: {difference}"
    return len(names[0]), ""


def compare_records(before: Mapping[str, Any], after: Mapping[str, Any], ignored: Iterable[str] = ()) -> str:
    """Return the first difference of two records, each its arrays by name and ``meta``; empty where they are equal, NaN
    to NaN.

    A record of an episode that broke counts as different, even from its like.
    """
    difference = _first_of_arrays(before, after) or _first_of_meta(
        before.get("meta", {}), after.get("meta", {}), {*CODE, *ignored}
    )
    if not difference and before.get("meta", {}).get("outcome") == "error":
        return f"both broke: {before['meta'].get('error')}"
    return difference


def _first_of_arrays(before: Mapping[str, Any], after: Mapping[str, Any]) -> str:
    for name in sorted({*before, *after} - {"meta"}):
        if name in SINCE and name not in before:
            continue
        if name not in before or name not in after:
            return f"{name}: only {'before' if name in before else 'after'}"
        one, other = before[name], after[name]
        if one.dtype != other.dtype or one.shape != other.shape:
            return f"{name}: {one.dtype} {one.shape}, then {other.dtype} {other.shape}"
        if one.tobytes() != other.tobytes():
            return f"{name}: {_first_element(one, other)}"
    return ""


def _first_element(one: Any, other: Any) -> str:
    """Return where two arrays of one shape differ first, and how."""
    bits = [
        np.ascontiguousarray(array).reshape(-1).view(np.uint8).reshape(array.size, array.itemsize)
        for array in (one, other)
    ]
    place = np.unravel_index(int(np.flatnonzero((bits[0] != bits[1]).any(axis=1))[0]), one.shape)
    return f"[{', '.join(map(str, place))}] is {one[place]!r}, then {other[place]!r}"


def _first_of_meta(before: Any, after: Any, ignored: set[str], key: str = "") -> str:
    if key in ignored:
        return ""
    if isinstance(before, Mapping) and isinstance(after, Mapping):
        for name in sorted({*before, *after}):
            inside = f"{key}.{name}".lstrip(".")
            if difference := _first_of_meta(before.get(name), after.get(name), ignored, inside):
                return difference
        return ""
    return "" if repr(before) == repr(after) else f"meta.{key}: {_short_repr(before)}, then {_short_repr(after)}"


def _short_repr(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _read_arrays(path: Path) -> dict[str, Any]:
    with np.load(path, allow_pickle=False) as file:
        content: dict[str, Any] = dict(file)
    if "meta" in content:
        content["meta"] = json.loads(str(content["meta"]))
    return content


def _print_table(found: Mapping[str, tuple[int, str]]) -> int:
    """Print the table; return the exit status."""
    width = max(map(len, found))
    print(f"{'run'.ljust(width)}  episodes  records")
    for name, (episodes, difference) in found.items():
        print(f"{name.ljust(width)}  {episodes:8}  {difference or 'equal'}")
    different = sum(bool(difference) for _, difference in found.values())
    print(f"{len(found) - different} of {len(found)} runs are equal")
    return int(different > 0)


def _run_checkout(checkout: Path, folder: Path, names: Sequence[str]) -> None:
    """Have a checkout's own interpreter make the runs below a folder; what is there already is kept."""
    missing = [name for name in names if not (folder / name / "records").is_dir()]
    barn = folder / BARN_WORLD
    barn.parent.mkdir(parents=True, exist_ok=True)
    posts = "".join(POST.format(k=k, x=-3.5 + 0.15 * k, y=8.0) for k in range(20))
    barn.write_text(f"<sdf version='1.6'><world name='default'>{posts}</world></sdf>")
    command = [str(_python_path(checkout)), "-P", str(Path(__file__).resolve()), "--record", *missing]
    status = subprocess.run(command, cwd=folder).returncode
    if status:
        print(f"{checkout}: ended with status {status}", file=sys.stderr)


def _python_path(checkout: Path) -> Path:
    return checkout / ".venv" / "bin" / "python"


def make_runs(names: Sequence[str]) -> None:
    """Make the runs in the working directory with the packages of this interpreter."""
    (command,) = entry_points(group="console_scripts", name="arena")  # wherever this checkout keeps it
    arena = command.load()
    for name in names:
        print(f"{name} ...", file=sys.stderr)
        if name in TRAININGS:
            _record_training(name)
        else:
            # one that is refused leaves no record
            arena(["run", *_known_overrides(RUNS[name].split()), *ALWAYS, f"hydra.run.dir={name}"])


def _known_overrides(words: Sequence[str]) -> list[str]:
    """Return the overrides with those alternatives that this checkout has."""
    from arena_core import ConfigurationError

    try:
        from arena_core.hosting import compose
    except ImportError:  # a checkout of before
        from arena_core import compose

    chosen = [word for word in words if "|" not in word]
    for word in words:
        for alternative in word.split("|") if "|" in word else ():
            with suppress(ConfigurationError):
                compose([*chosen, alternative])
                chosen.append(alternative)
                break
    return chosen


def _record_training(name: str) -> None:
    """Step an environment by fixed actions; write its observations and rewards as a record."""
    import gymnasium

    import arena_gym.envs  # noqa: F401 - registers the environments

    settings, worlds, steps = TRAININGS[name]
    envs: Any = gymnasium.make_vec(
        "arena/Navigation-v0", num_envs=worlds, vectorization_mode="vector_entry_point", **settings
    )
    first, _ = envs.reset(seed=0)
    envs.action_space.seed(0)
    steps_taken = [envs.step(_forward_actions(envs.action_space.sample())) for _ in range(steps)]
    observations, rewards, terminated, truncated, _ = zip(*steps_taken, strict=True)
    arrays = {
        "first": first,
        "observations": observations,
        "rewards": rewards,
        "terminated": terminated,
        "truncated": truncated,
    }
    (folder := Path(name, "records")).mkdir(parents=True)
    np.savez(folder / "0000.npz", **{key: np.array(value) for key, value in arrays.items()})


def _forward_actions(actions: Any) -> Any:
    """Return velocities that lead ahead, or nothing would be met; choices of a planner as they are."""
    return np.concatenate((np.abs(actions[:, :1]), actions[:, 1:]), axis=1) if actions.ndim > 1 else actions


if __name__ == "__main__":
    sys.exit(make_runs(sys.argv[2:]) if sys.argv[1:2] == ["--record"] else main(sys.argv[1:]))
