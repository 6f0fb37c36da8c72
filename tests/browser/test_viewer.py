"""The replay page in chromium: it opens from a file and from its server, moves, and is quick."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import arena_core as arena
from arena_core.records import FindingMark, Findings, write_findings
from arena_viewer.command import ReplayCommand
from arena_viewer.document import read_recorded, replay_document
from arena_viewer.live import LiveRuns
from arena_viewer.page import live_page
from arena_viewer.page import replay_page as page_of
from arena_viewer.serving import PageServer, page_answer

pytestmark = pytest.mark.browser
PEOPLE = 100
WHEN_READY = """() => new Promise((ready) => {
  const ask = () => (window.arena ? ready() : setTimeout(ask, 50));
  ask();
})"""  # wait_for_function evaluates text over and over, which the server's policy of content forbids


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Let two planners drive the same two scenarios."""
    where = tmp_path_factory.mktemp("drives")
    rest = [
        "robot=jackal",
        "world=warehouse",
        "task.pedestrians=4",
        "episodes=2",
        "task.time_limit=12",
        "localizer=ground_truth",
    ]
    found = []
    for planner in ("pure_pursuit", "dwa"):
        arena.run([f"planner={planner}", *rest, "executor=serial", "report=false"], where / planner)
        found.append(where / planner)
    return found


@pytest.fixture
def opened(folders: list[Path], tmp_path: Path, show: Callable[[Path], Any]) -> Any:
    """Open both planners' first episode from one file."""
    target = tmp_path / "both.html"
    ReplayCommand().run([str(folders[0]), "0", f"with={folders[1]}", "--to", str(target)])
    opened = show(target)
    opened.page.wait_for_function("window.arena")
    return opened


def test_page_opens_from_a_file_and_asks_nobody(opened: Any) -> None:
    assert opened.complaints == []
    assert [url for url in opened.requests if not url.startswith(("file:", "data:"))] == []
    assert opened.overflow <= 0
    assert [text.split("\n")[0] for text in opened.page.locator("#facts b").all_inner_texts()] == [
        "pure_pursuit on jackal",
        "dwa on jackal",
    ]


@pytest.fixture
def explained(folders: list[Path], tmp_path: Path, show: Callable[[Path], Any]) -> Any:
    """Open an episode about which something was found out."""
    copied = shutil.copytree(folders[0], tmp_path / "run")
    way = tuple((0.1 * k, 0.2 * k) for k in range(20))
    moment = FindingMark("last avoidable moment", 1.0, "ran into a wall, 1.0 s later; until here turning would do", way)
    stand = FindingMark("stand", 1.2, "stood 4.0 s: nothing was near")
    write_findings(copied, Findings("explain", "abc", (), {}, {0: [moment, stand]}))
    target = tmp_path / "explained.html"
    ReplayCommand().run([str(copied), "0", "--to", str(target)])
    opened = show(target)
    opened.page.wait_for_function("window.arena")
    return opened


def test_marks_above_the_slider_say_what_could_be_avoided_and_lead_there(explained: Any) -> None:
    page = explained.page
    (mark,) = page.locator("#marks button.moment").all()
    assert mark.get_attribute("title").startswith("1.0 s: ran into a wall, 1.0 s later")
    slider, place = page.locator("#time").bounding_box(), mark.bounding_box()
    at = (place["x"] + place["width"] / 2 - slider["x"] - 8) / (slider["width"] - 16)
    assert at == pytest.approx(1.0 / page.evaluate("arena.player.end"), abs=0.02)
    mark.click()
    assert page.evaluate("arena.player.time") == pytest.approx(1.0)
    page.wait_for_function("document.querySelector('#facts .now').textContent.includes('turning would do')")
    page.evaluate("document.activeElement.blur(); arena.player.seek(0)")
    page.keyboard.press("n")
    assert page.evaluate("arena.player.time") == pytest.approx(1.0)
    page.evaluate("arena.player.seek(1.3)")
    page.wait_for_function("document.querySelector('#facts .now').textContent.includes('stood 4.0 s')")
    assert explained.complaints == []
    assert explained.overflow <= 0


def test_the_way_out_is_drawn_and_can_be_left_out(explained: Any) -> None:
    page = explained.page
    page.evaluate("arena.player.seek(1)")
    page.wait_for_timeout(100)
    drawn = page.evaluate("document.getElementById('picture').toDataURL()")
    page.locator("#layer-way_out").click()
    page.wait_for_function("!arena.view.layers.way_out")
    page.wait_for_function("drawn => document.getElementById('picture').toDataURL() !== drawn", arg=drawn)


DRAWN = """() => {
  arena.stage.draw(arena.view.panes, arena.player.time, arena.view.layers, 1);
  const gl = arena.stage.renderer.getContext(), [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const data = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, data);
  const colours = new Set();
  for (let at = 0; at < data.length; at += 4) colours.add((data[at] << 16) | (data[at + 1] << 8) | data[at + 2]);
  return colours.size;
}"""  # how many colours the solid world has


def test_the_world_can_be_seen_in_three_dimensions_from_four_places(opened: Any) -> None:
    page = opened.page
    page.evaluate("document.activeElement.blur(); arena.player.seek(4)")
    page.keyboard.press("3")
    page.wait_for_function("arena.view.solid")
    assert page.locator("#solid").is_visible()
    assert not page.locator("#picture").is_visible()
    assert opened.overflow <= 0
    seen = []
    for mode in ("orbit", "follow", "onboard", "above"):
        page.wait_for_function("mode => arena.stage.mode === mode", arg=mode)
        assert page.evaluate(DRAWN) > 40
        seen.append(page.evaluate("arena.stage.world(arena.view.panes[0]).eye.camera.position.toArray()"))
        page.keyboard.press("c")
    onboard, pose = seen[2], page.evaluate("arena.episodes[0].at(4).pose")
    assert onboard[:2] == pytest.approx(pose[:2], abs=0.3)
    assert len({tuple(place) for place in seen}) == 4
    assert [url for url in opened.requests if not url.startswith(("file:", "data:"))] == []
    page.keyboard.press("3")
    page.wait_for_function("!arena.view.solid")
    assert page.locator("#picture").is_visible()
    assert [said for said in opened.complaints if "ReadPixels" not in said] == []  # which this test does


def test_dragging_turns_the_solid_world_and_the_wheel_comes_nearer(opened: Any) -> None:
    page = opened.page
    page.locator("#solid-on").check()
    page.wait_for_function("arena.view.solid && arena.stage.worlds.size")
    before = page.evaluate("arena.stage.world(arena.view.panes[0]).eye.azimuth")
    box = page.locator("#solid").bounding_box()
    page.mouse.move(box["x"] + 60, box["y"] + 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 110, box["y"] + 60)
    page.mouse.up()
    page.wait_for_function("before => arena.stage.world(arena.view.panes[0]).eye.azimuth < before - 0.1", arg=before)
    page.mouse.wheel(0, -400)
    page.wait_for_function("arena.stage.world(arena.view.panes[0]).eye.distance > 0")


def test_a_browser_that_draws_nothing_solid_is_told_so_and_shows_the_picture(opened: Any) -> None:
    page = opened.page
    page.evaluate("HTMLCanvasElement.prototype.getContext = () => null")
    page.locator("#solid-on").click()
    page.wait_for_function("document.getElementById('trouble').textContent.includes('no WebGL')")
    assert not page.locator("#solid-on").is_checked()
    assert page.locator("#picture").is_visible()


def test_keys_play_stop_and_step(opened: Any) -> None:
    page = opened.page
    page.keyboard.press("Space")
    page.wait_for_function("arena.player.time > 0.3")
    page.keyboard.press("Space")
    assert not page.evaluate("arena.player.playing")
    page.evaluate("arena.player.seek(2)")
    page.keyboard.press(".")
    assert page.evaluate("arena.player.time") == pytest.approx(2.1)
    page.keyboard.press("End")
    assert page.evaluate("arena.player.time === arena.player.end")
    page.keyboard.press("b")
    assert page.evaluate("arena.view.panes.length") == 1


def test_picture_shows_the_robot_where_the_record_says(opened: Any) -> None:
    page = opened.page
    page.evaluate("arena.player.seek(3)")
    page.wait_for_timeout(300)
    colour = page.evaluate(
        """() => {
          const [pane, camera] = [arena.view.panes[0], arena.view.camera];
          const { pose } = arena.episodes[0].at(3);
          const x = pane.x + pane.width / 2 + (pose[0] - camera.x) * camera.scale;
          const y = pane.y + pane.height / 2 - (pose[1] - camera.y) * camera.scale;
          const ratio = window.devicePixelRatio, canvas = document.getElementById("picture");
          const [left, top] = [Math.round(ratio * x) - 4, Math.round(ratio * y) - 4];
          const data = canvas.getContext("2d").getImageData(left, top, 9, 9).data;
          const near = [];
          for (let i = 0; i < data.length; i += 4) near.push([data[i], data[i + 1], data[i + 2]].join());
          return near;
        }"""
    )
    assert "0,114,178" in colour or "179,71,11" in colour  # the robot's colour, or that of a contact


def test_pages_own_sums_agree_with_the_record(opened: Any, folders: list[Path]) -> None:
    record = read_recorded(folders[1], 0).record
    row = len(record["stamp"]) // 2
    pose = opened.page.evaluate(f"arena.episodes[1].at({float(record['stamp'][row])} + 1e-4).pose")
    assert pose[:2] == pytest.approx(record["pose"][row][:2], abs=0.01)


def test_beams_that_are_cast_anew_end_where_the_simulator_had_them(opened: Any, folders: list[Path]) -> None:
    record = read_recorded(folders[0], 0).record
    least = opened.page.evaluate(
        """async () => {
          const { cast } = await import("arena/lidar.js");
          const episode = arena.episodes[0], moment = episode.at(1.0001);
          return Math.min(...cast(episode.map, moment.pose, episode.said.robot.lidar, moment.people));
        }"""
    )
    row = int((record["stamp"] <= 1.0001).sum()) - 1
    # noise, and a scan of a tenth of a second before
    assert least == pytest.approx(float(record["scan_min"][row]), abs=0.15)


def test_frames_among_a_hundred_people_are_drawn_in_time(
    folders: list[Path], tmp_path: Path, show: Callable[[Path], Any]
) -> None:
    """The median is not held to a number: a busy machine's is no fact. That all of them are drawn is."""
    words = [
        "planner=pure_pursuit",
        "robot=jackal",
        "world=outdoor_large",
        f"task.pedestrians={PEOPLE}",
        "episodes=1",
        "task.time_limit=4",
    ]
    arena.run([*words, "executor=serial", "report=false", "localizer=ground_truth"], tmp_path / "crowd")
    ReplayCommand().run([str(tmp_path / "crowd"), "--to", str(tmp_path / "crowd.html")])
    page = show(tmp_path / "crowd.html").page
    page.wait_for_function("window.arena")
    assert page.evaluate("arena.episodes[0].at(1).people.length") == PEOPLE
    page.evaluate("arena.player.toggle()")
    page.wait_for_function("!arena.player.playing")
    spent = sorted(page.evaluate("arena.spent"))
    print(f"script of a frame: median {spent[len(spent) // 2]:.1f} ms, p95 {spent[int(0.95 * len(spent))]:.1f} ms")
    assert len(spent) > 20


def test_what_was_recorded_of_thoughts_and_legs_is_drawn(tmp_path: Path, show: Callable[[Path], Any]) -> None:
    words = [
        "planner=dwa",
        "robot=jackal",
        "world=warehouse",
        "task.pedestrians=4",
        "episodes=1",
        "task.time_limit=4",
        "tracker=kalman_legs",
    ]
    kept = [
        "recording.considered=true",
        "recording.tracks=true",
        "pedestrians.body=legs",
        "executor=serial",
        "report=false",
    ]
    arena.run([*words, *kept], tmp_path / "run")
    ReplayCommand().run([str(tmp_path / "run"), "--to", str(tmp_path / "one.html")])
    opened = show(tmp_path / "one.html")
    page = opened.page
    page.wait_for_function("window.arena")
    page.evaluate("arena.player.seek(2)")
    page.wait_for_timeout(300)
    assert opened.complaints == []
    assert page.locator("#layer-considered").is_checked()
    record = read_recorded(tmp_path / "run", 0).record
    row = page.evaluate("arena.episodes[0].rowAt(2)")
    shown = page.evaluate("arena.episodes[0].considered(arena.episodes[0].rowAt(2)).length")
    assert shown == record["considered_rows"][row + 1] - record["considered_rows"][row]
    person = page.evaluate("arena.episodes[0].at(2).people[0]")
    left, right = person["legs"][:2], person["legs"][2:4]
    assert [(a + b) / 2 for a, b in zip(left, right, strict=True)] == pytest.approx(
        [person["x"], person["y"]], abs=1e-3
    )


def test_runs_under_way_are_shown_and_lead_to_replays(folders: list[Path], chromium: Any) -> None:
    watched = LiveRuns(folders[0])
    replay = page_answer(page_of("replay", None))
    more = {"/replay": replay, "/document": watched.document, "/state": watched.state, "/map": watched.map}
    server = PageServer(live_page("live"), b"", more=more)
    thread = threading.Thread(target=server.serve)
    thread.start()
    try:
        page = chromium.new_page()
        complaints: list[str] = []
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(server.address)
        page.locator("#finished tr").nth(1).wait_for()
        assert page.inner_text("#standing").startswith("2 of 2 episodes")
        with page.context.expect_page() as opened:
            page.click("#finished a")
        opened.value.locator("#facts li").first.wait_for()
        assert complaints == []
        page.close()
        opened.value.close()
    finally:
        server.shutdown()
        thread.join()


@pytest.mark.parametrize("name", ["replay", "live"])
def test_pages_are_accessible(name: str, folders: list[Path], tmp_path: Path, show: Callable[[Path], Any]) -> None:
    axe = Path(__file__).parents[2] / "node_modules" / "axe-core" / "axe.min.js"
    text = page_of("replay", replay_document([read_recorded(folders[0], 0)])) if name == "replay" else live_page("live")
    (tmp_path / "page.html").write_text(text)
    page = show(tmp_path / "page.html").page
    page.wait_for_timeout(300)
    page.evaluate(axe.read_text())
    found = page.evaluate(
        "axe.run().then((said) => said.violations.map((one) => `${one.id}: ${one.nodes.map((node) => node.html)}`))"
    )
    assert found == []


@pytest.fixture
def server(folders: list[Path]) -> Iterator[PageServer]:
    server = PageServer(page_of("replay", None), replay_document([read_recorded(folders[0], 0)]))
    thread = threading.Thread(target=server.serve)
    thread.start()
    yield server
    server.shutdown()
    thread.join()


def test_page_of_the_server_fetches_its_document(server: PageServer, chromium: Any) -> None:
    page = chromium.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on(
        "console", lambda message: complaints.append(message.text) if message.type in ("error", "warning") else None
    )
    page.goto(server.address)
    page.evaluate(WHEN_READY)
    assert complaints == []
    page.close()


def test_damaged_document_is_said_in_the_page(folders: list[Path], tmp_path: Path, show: Callable[[Path], Any]) -> None:
    target = tmp_path / "bad.html"
    target.write_text(page_of("bad", b"no document"))
    page = show(target).page
    page.wait_for_selector("#trouble:not([hidden])")
    assert "This cannot be shown" in page.inner_text("#trouble")
