"""Time what a user of the studio waits for, in headless chromium: opening it, an episode, filters, drawing on a large
map, saving it.

    scripts/setup browser python benchmarks/studio_speed.py [STEP...]      steps: open, episode, filter, map, frames;
    all of them unless some are named

Prints a line for each figure with its goal. Figures of a busy machine say nothing.
"""

from __future__ import annotations

import csv
import json
import statistics
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import arena_core as arena
from arena_core.records import EPISODE_COLUMNS

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scripts"))
from studio_in_chromium import start_browser, start_studio

PATIENCE = 300.0  # s
REPEATS = 7
EPISODES, RUNS = 100_000, 20  # that are filtered
SIDE = 4000  # cells of the large map
STROKE = 3.0  # s that a person draws
SLOW = (
    "robot=turtlebot3 planner=pure_pursuit localizer=ground_truth task.time_limit=60 task.trip.min_distance=20 "
    "task.trip.max_distance=30"
)
EDITOR = "document.querySelector('.page.map').editor"
SAVED = f"{EDITOR}.map.autosave.state === 'saved' && !{EDITOR}.map.autosave.unsaved && !{EDITOR}.map.autosave.running"


def main() -> None:
    """Take the figures and print them."""
    steps = {
        "open": open_studio,
        "episode": open_episodes,
        "filter": filter_results,
        "map": draw_on_map,
        "frames": play_crowd,
    }
    chosen = sys.argv[1:] or list(steps)
    if unknown := set(chosen) - steps.keys():
        sys.exit(f"{', '.join(sorted(unknown))}: no such step; allowed: {', '.join(steps)}")
    with TemporaryDirectory() as name:
        project = Path(name) / "lab"
        project.mkdir()
        with start_studio(project) as address, start_browser() as chromium:
            for step in chosen:
                steps[step](project, address, chromium)


def print_figure(what: str, value: float, unit: str, goal: float | None = None, least: bool = False) -> None:
    """Print a figure, and whether it keeps its goal, the most or the ``least`` that is wanted."""
    said = ""
    if goal is not None:
        kept = value >= goal if least else value <= goal
        said = f"   goal {'>=' if least else '<='} {goal:g} {unit}: {'kept' if kept else 'MISSED'}"
    print(f"{what:62s} {value:9.3f} {unit:8s}{said}", flush=True)


def print_times(what: str, times: list[float], goal: float | None = None) -> None:
    """Print the median and the longest of some times, s."""
    print_figure(f"{what}, median of {len(times)}", statistics.median(times), "s", goal)
    print_figure(f"{what}, longest", max(times), "s")


def open_studio(project: Path, address: str, chromium: Any) -> None:
    """Open the first page in new windows until its form can be filled in."""
    times = []
    for _ in range(REPEATS):
        page = open_window(chromium)
        began = time.perf_counter()
        page.goto(address)
        wait_for(page, "document.querySelectorAll('.experiment-form select').length > 0")
        times.append(time.perf_counter() - began)
        wait_for(page, "!!document.getElementById('command').textContent")
        page.context.close()
    print_figure("opening the studio, the first time", times[0], "s", 1.0)
    print_times("opening the studio, again", times[1:], 1.0)


def open_episodes(project: Path, address: str, chromium: Any) -> None:
    """Open recorded episodes of a minute until their first frame is drawn."""
    for people in (10, 100):
        run = record_episode(project, people)
        page = open_session(chromium, address)
        times = []
        for _ in range(REPEATS):
            page.goto(f"{root_of(address)}/replay/?run={run}&episode=0")
            times.append(wait_for(page, "window.arena?.spent.length ? performance.now() : 0") / 1000)
        end = page.evaluate("arena.player.end")
        print_times(f"opening an episode of {end:.0f} s among {people} people", times, 0.5)
        page.context.close()


def filter_results(project: Path, address: str, chromium: Any) -> None:
    """Choose a planner, look for words, sort: from the click to the table that shows it."""
    write_runs(project)
    page = open_session(chromium, address)
    began = time.perf_counter()
    page.evaluate("location.hash = '#/results'")
    wait_for(page, f"document.getElementById('facts')?.textContent.startsWith('{EPISODES:,}')")
    print_figure(f"reading the tables of {EPISODES:,} episodes", time.perf_counter() - began, "s")
    pause = 200  # ms that the page waits for another key
    acts = {
        "choosing a planner": ('document.querySelector(\'[data-column="preset"] [data-value="teb"]\').click()', 0),
        "looking for two words": (typing_script("random/12 goal"), pause),
        "sorting": ("document.querySelector('th [data-column=\"time_to_goal\"]').click()", 0),
        "looking for nothing": (typing_script(""), pause),
    }
    for what, (act, waits) in acts.items():
        taken = page.evaluate(f"""() => new Promise((done) => {{
            const table = document.querySelector(".episodes"), began = performance.now();
            const end = () => requestAnimationFrame(() => done(performance.now() - began));
            new MutationObserver((_, seen) => {{ seen.disconnect(); end(); }})
              .observe(table, {{ childList: true, subtree: true }});
            {act};
          }})""")
        print_figure(f"{what}, of {EPISODES:,} episodes", (taken - waits) / 1000, "s", 0.3)
    page.context.close()


def draw_on_map(project: Path, address: str, chromium: Any) -> None:
    """Draw, fill and save on a large map, as a whole and near by."""
    for kind in ("pgm", "png"):
        path = write_map(project, kind)
        page = open_session(chromium, address)
        began = time.perf_counter()
        page.evaluate(f"location.hash = '#/map?path={path}'")
        wait_for(page, f"document.querySelector('.page.map')?.editor?.map?.header.path === '{path}'")
        print_figure(f"opening a map of {SIDE} x {SIDE} cells, {kind.upper()}", time.perf_counter() - began, "s")
        for where, zoom in (("seen as a whole", 1.0), ("near by", 8.0)):
            page.evaluate(f"{EDITOR}.view.fit(); {EDITOR}.view.zoom({zoom})")
            page.evaluate(f"{EDITOR}.toolbox.choose('brush'); {EDITOR}.setPencil({{width: 1}})")
            draw_stroke(page, f"brush on it, {where}")
            print_saving(page, f"saving that stroke, {kind.upper()}")
        fills = [fill_map(page) for _ in range(4)]
        print_figure("filling 15 million cells, longest of 4", max(fills), "s")
        print_saving(page, f"saving that fill, {kind.upper()}")
        page.context.close()


def draw_stroke(page: Any, what: str) -> None:
    """Draw back and forth for some seconds, as fast as the browser takes it, and tell its frames."""
    box = page.locator("canvas").bounding_box()
    page.evaluate("""() => {
      window.frames_ = []; let before = performance.now();
      const step = (now) => { frames_.push(now - before); before = now; if (frames_) requestAnimationFrame(step); };
      requestAnimationFrame(step);
    }""")
    drawn, began = page.evaluate(f"{EDITOR}.view.drawn"), time.perf_counter()
    page.mouse.move(box["x"] + 200, box["y"] + 200)
    page.mouse.down()
    number = 0
    while time.perf_counter() - began < STROKE:
        number += 1
        page.mouse.move(box["x"] + 200 + (7 * number) % 500, box["y"] + 200 + (3 * number) % 300)
    taken, frames = time.perf_counter() - began, page.evaluate(f"{EDITOR}.view.drawn") - drawn
    gaps = sorted(page.evaluate("(() => { const found = frames_; window.frames_ = null; return found; })()"))
    page.mouse.up()
    print_figure(f"{what}", frames / taken, "frames/s", 30.0, least=True)
    print_figure(f"{what}, 95 of 100 frames after", gaps[int(0.95 * len(gaps))], "ms")


def print_saving(page: Any, what: str) -> None:
    """Tell how long the request takes that saves what is not saved yet."""
    began = time.perf_counter()
    page.evaluate(f"{EDITOR}.map.autosave.flush()")
    wait_for(page, SAVED)
    print_figure(what, time.perf_counter() - began, "s", 1.0)


def fill_map(page: Any) -> float:
    """Fill all that is free with another kind, or back; return how long the script took, s."""
    act = f"""(() => {{
      const editor = {EDITOR}, kinds = ["free", "unknown"];
      const tool = editor.toolbox.tools.find(({{ name }}) => name === "fill");
      editor.setPencil({{ kind: kinds[(window.turn_ = (window.turn_ ?? 0) + 1) % 2] }});
      const began = performance.now();
      tool.down({{ point: [0.5, 0.5], shift: false, alt: true, double: false }});
      return performance.now() - began;
    }})()"""
    return float(page.evaluate(act)) / 1000


def play_crowd(project: Path, address: str, chromium: Any) -> None:
    """Play an episode among a hundred people, and tell what the script of a frame takes."""
    run = record_episode(project, 100)
    page = open_session(chromium, address)
    page.goto(f"{root_of(address)}/replay/?run={run}&episode=0")
    wait_for(page, "window.arena?.spent.length > 0")
    page.evaluate("arena.spent.length = 0; arena.player.toggle()")
    wait_for(page, "arena.spent.length >= 240")
    spent = sorted(page.evaluate("arena.spent"))
    print_figure("script of a frame among 100 people, median", spent[len(spent) // 2], "ms")
    print_figure("script of a frame among 100 people, 95 of 100", spent[int(0.95 * len(spent))], "ms", 8.0)
    page.context.close()


def record_episode(project: Path, people: int) -> str:
    """Return a run of one episode of a minute among so many people on legs, driven where it is not there yet."""
    name = f"outputs/among_{people}"
    if not (project / name / "episodes.csv").exists():
        more = [
            f"task.pedestrians={people}",
            "world=outdoor_large",
            "pedestrians.body=legs",
            "episodes=1",
            "executor=serial",
        ]
        arena.run([*SLOW.split(), *more, "report=false"], project / name)
    return name


def write_runs(project: Path) -> None:
    """Write tables of many episodes, without records."""
    facts = {
        "robot": "jackal",
        "world": "indoor",
        "task": "random",
        "outcome": "goal_reached",
        "success": 1,
        "seed": 0,
        "config_hash": "0",
    }
    for run in range(RUNS):
        preset = ("dwa", "teb", "mpc", "orca")[run % 4]
        folder = project / "many" / str(run)
        folder.mkdir(parents=True)
        with (folder / "episodes.csv").open("w", newline="") as file:
            writer = csv.DictWriter(
                file, [*EPISODE_COLUMNS, "success", "time_to_goal", "path_length"], restval="", lineterminator="\n"
            )
            writer.writeheader()
            for number in range(EPISODES // RUNS):
                own = {
                    "episode": number,
                    "scenario": f"random/{number:04d}",
                    "time_to_goal": 10 + number % 97,
                    "path_length": number % 31,
                }
                writer.writerow({**facts, "planner": preset, "preset": preset, **own})


def write_map(project: Path, kind: str) -> str:
    """Write a large map with walls in it; return its path."""
    from PIL import Image

    cells = np.full((SIDE, SIDE), 254, np.uint8)
    random = np.random.default_rng(0)
    for row, column, length in random.integers(100, SIDE - 500, (400, 3)):
        cells[row : row + 4, column : column + length % 400] = 0
    cells[:4], cells[-4:], cells[:, :4], cells[:, -4:] = 0, 0, 0, 0
    Image.fromarray(cells).save(project / f"large_{kind}.{kind}")
    text = {"image": f"large_{kind}.{kind}", "resolution": 0.05, "origin": [0.0, 0.0, 0.0], "negate": 0}
    text |= {"occupied_thresh": 0.65, "free_thresh": 0.196}
    (project / f"large_{kind}.yaml").write_text("".join(f"{key}: {json.dumps(value)}\n" for key, value in text.items()))
    return f"large_{kind}.yaml"


def typing_script(text: str) -> str:
    """Return a script that types a text into the search."""
    search = "document.querySelector('input[type=search]')"
    return f"{search}.value = {json.dumps(text)}; {search}.dispatchEvent(new Event('input'))"


def open_session(chromium: Any, address: str) -> Any:
    """Return a new window that the studio knows."""
    page = open_window(chromium)
    page.goto(address)
    wait_for(page, "!!document.getElementById('command')?.textContent")
    return page


def open_window(chromium: Any) -> Any:
    """Return a page of a window without history, cookies or cache."""
    page = chromium.new_context(viewport={"width": 1280, "height": 900}).new_page()
    page.set_default_timeout(1000 * PATIENCE)
    return page


def wait_for(page: Any, expression: str) -> Any:
    """Wait until an expression is true and return it; the studio's policy forbids playwright's own way."""
    end = time.monotonic() + PATIENCE
    while not (value := page.evaluate(expression)):
        if time.monotonic() > end:
            sys.exit(f"{expression} never became true")
        time.sleep(0.002)
    return value


def root_of(address: str) -> str:
    """Return an address without its token."""
    return address.partition("/?")[0]


if __name__ == "__main__":
    main()
