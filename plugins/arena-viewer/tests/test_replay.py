"""The replay document says what the record says; the page, the server and the files made of it."""

import base64
import gzip
import http.client
import json
import shutil
import threading
from dataclasses import replace
from importlib.resources import files
from urllib.parse import urlsplit

import numpy as np
import pytest
from PIL import Image

import arena_core as arena
from arena_core import ConfigurationError, EpisodeRecord, InputFileError
from arena_core.records import FindingMark, Findings, write_findings
from arena_viewer.command import ReplayCommand, read_request
from arena_viewer.document import read_document, read_recorded, replay_document, time_to_collision
from arena_viewer.page import LIVE_MODULES, MODULES, replay_page
from arena_viewer.serving import PageServer
from arena_viewer.stills import EpisodeStills, view_bounds


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Drive one short episode among three people."""
    where = tmp_path_factory.mktemp("replay") / "run"
    words = [
        "planner=pure_pursuit",
        "robot=jackal",
        "world=empty",
        "world.width=8",
        "world.height=8",
        "task.pedestrians=3",
        "episodes=2",
    ]
    arena.run([*words, "executor=serial", "localizer=ground_truth", "report=false"], where)
    return where


@pytest.fixture(scope="module")
def recorded(folder):
    return read_recorded(folder, 0)


def test_document_holds_what_was_found_out_about_its_episode_alone(folder, tmp_path):
    copied = shutil.copytree(folder, tmp_path / "run")
    marks = {0: [FindingMark("last avoidable moment", 1.5, "until here", ((0.0, 1.0), (1.0, 1.0)))]}
    write_findings(copied, Findings("explain", "abc", (), {}, marks))
    header, _ = read_document(replay_document([read_recorded(copied, number) for number in (0, 1)]))
    told = {"kind": "last avoidable moment", "stamp": 1.5, "text": "until here", "way": [[0.0, 1.0], [1.0, 1.0]]}
    assert header["episodes"][0]["marks"] == [told]
    assert "marks" not in header["episodes"][1]


def test_document_holds_the_record_to_half_a_millimetre(recorded):
    header, arrays = read_document(replay_document([recorded]))
    record = recorded.record
    for name, of in (
        ("pose", "pose"),
        ("people", "pedestrian_positions"),
        ("clearance", "clearance"),
        ("stamp", "stamp"),
    ):
        assert arrays[0, name].shape == record[of].shape
        assert arrays[0, name] == pytest.approx(record[of], abs=0.0006)
    assert np.array_equal(arrays[0, "states"], record["pedestrian_states"])
    (said,) = header["episodes"]
    assert said["columns"]["planner"] == "pure_pursuit"
    assert said["metrics"]["collisions"] == len(record["contact_stamp"])


def test_document_is_the_same_twice_and_small(recorded):
    content = replay_document([recorded])
    assert content == replay_document([recorded])
    assert len(content) < 60_000


def test_episodes_of_one_world_share_its_map(recorded):
    header, _ = read_document(replay_document([recorded, recorded]))
    assert len(header["maps"]) == 1
    assert [episode["map"] for episode in header["episodes"]] == [0, 0]
    assert header["maps"][0]["cells"]["shape"] == list(recorded.grid.data.shape)


def test_header_has_no_figure_that_json_does_not_know(recorded):
    raw = gzip.decompress(replay_document([recorded]))
    text = raw[8 : 8 + int.from_bytes(raw[4:8], "little")].decode()
    json.loads(text, parse_constant=lambda name: pytest.fail(name))


@pytest.mark.parametrize(
    "content", [b"", b"no", gzip.compress(b"ARPL", mtime=0), gzip.compress(b"ARPL\x02\x00\x00\x00{}", mtime=0)]
)
def test_what_is_no_document_is_one_line(content):
    with pytest.raises(InputFileError, match="replay document"):
        read_document(content)


def towards(recorded, ahead, speed):
    """Return a record of two rows in which one person stands ``ahead`` m in front of a robot
    that drives at ``speed`` m/s.
    """
    arrays = {
        "pose": np.zeros((2, 3)),
        "twist": np.tile((speed, 0.0, 0.0), (2, 1)),
        "pedestrian_radii": np.array([0.3]),
    }
    arrays |= {"pedestrian_positions": np.tile((ahead, 0.0), (2, 1, 1)), "pedestrian_velocities": np.zeros((2, 1, 2))}
    return EpisodeRecord(arrays, recorded.record.meta)


def test_time_to_collision_of_a_robot_that_drives_at_a_person(recorded):
    assert time_to_collision(towards(recorded, 2.0, 1.0))[0] == pytest.approx((2.0 - 0.3 - 0.26707) / 1.0, abs=1e-3)


def test_nobody_is_hit_by_a_robot_that_drives_off(recorded):
    assert np.isinf(time_to_collision(towards(recorded, 2.0, -1.0))).all()


def test_page_has_all_that_it_needs_inside(recorded):
    text = replay_page("a <title>", replay_document([recorded]))
    assert "a &lt;title&gt;" in text
    assert all(f'"arena/{name}.js"' in text for name in MODULES)
    assert "http://" not in text.replace("http://www.w3.org", "")
    assert "https://" not in text
    three = (files("arena_viewer") / "web" / "solid" / "three.module.min.js.gz").read_bytes()
    assert base64.b64encode(three).decode() in text
    assert len(text) < 250_000 + 4 / 3 * len(three)


def test_modules_of_the_page_are_all_there_are():
    web = files("arena_viewer") / "web"
    there = {path.name for path in web.iterdir() if path.name.endswith(".js")}
    there |= {f"solid/{path.name}" for path in (web / "solid").iterdir() if path.name.endswith(".js")}
    assert there == {f"{name}.js" for name in (*MODULES, *LIVE_MODULES)}


@pytest.fixture
def server(recorded):
    server = PageServer(replay_page("t", None), replay_document([recorded]))
    thread = threading.Thread(target=server.serve)
    thread.start()
    yield server
    server.shutdown()
    thread.join()


def asked(server, path, host=None):
    parts = urlsplit(server.address)
    connection = http.client.HTTPConnection(parts.hostname, parts.port, timeout=120)
    connection.request("GET", path, headers={"Host": host} if host else {})
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, content


def test_server_gives_page_and_document_to_who_knows_the_token(server, recorded):
    query = urlsplit(server.address).query
    assert asked(server, f"/?{query}")[0] == 200
    assert asked(server, f"/document?{query}") == (200, replay_document([recorded]))


@pytest.mark.parametrize(
    ("path", "host", "status"),
    [
        ("/", None, 403),
        ("/?token=wrong", None, 403),
        ("/document", None, 403),
        ("TOKEN", "evil.example:80", 403),
        ("/../../etc/passwd?TOKEN", None, 404),
        ("/%2e%2e/etc/passwd?TOKEN", None, 404),
    ],
)
def test_server_gives_nothing_else(server, path, host, status):
    query = urlsplit(server.address).query
    asked_for = f"/?{query}" if path == "TOKEN" else path.replace("TOKEN", query)
    assert asked(server, asked_for, host)[0] == status


def test_command_writes_a_page_a_strip_and_a_film(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("e.html", "e.png", "e.gif", "e.replay"):
        assert ReplayCommand().run([str(folder), "0", "--to", name, "side=200", "until=1", "rate=5", "moments=3"]) == 0
    with Image.open("e.png") as strip, Image.open("e.gif") as film:
        assert strip.width == 3 * 200 + 2 * 6
        assert film.n_frames == 5
    assert read_document((tmp_path / "e.replay").read_bytes())[0]["format"] == "arena-replay"


def test_two_runs_on_one_scenario_are_drawn_side_by_side_and_others_refused(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(folder, tmp_path / "other")
    words = [str(folder), "other", "0", "side=200", "until=1", "rate=5", "moments=3"]
    for name in ("two.png", "two.gif"):
        assert ReplayCommand().run([*words, "--to", name]) == 0
    with Image.open("two.png") as strips, Image.open("two.gif") as film:
        assert (strips.width, strips.height) == (3 * 200 + 2 * 6, 2 * 200 + 6)
        assert (film.width, film.height, film.n_frames) == (2 * 200 + 6, 200, 5)
    with pytest.raises(
        ConfigurationError,
        match=r"out is a\.gif of scenario random/0000 and random/0001; allowed: runs of the same scenario",
    ):
        ReplayCommand().run([str(folder), "0", "1", "--to", "a.gif"])
    with pytest.raises(ConfigurationError, match="8 episodes; allowed: up to 6"):
        ReplayCommand().run([str(folder), *["0"] * 8, "--to", "a.png"])


def changed(recorded, **changes):
    """Return an episode with other arrays, and another scenario where ``goal`` or ``doors`` are given."""
    of_scenario = {key: changes.pop(key) for key in ("goal", "doors") if key in changes}
    scenario = {**recorded.record.meta["scenario"], **of_scenario}
    meta = {
        **recorded.record.meta,
        "scenario": scenario,
        "events": changes.pop("events", recorded.record.meta["events"]),
    }
    return replace(recorded, record=replace(recorded.record, meta=meta, arrays={**recorded.record.arrays, **changes}))


def test_pictures_hold_the_whole_drive_and_a_goal_wherever_it_is(recorded):
    for goal in ([30.0, 2.0], [-12.0, -9.0], [4.0, 50.0]):
        left, right, bottom, top = view_bounds([changed(recorded, goal=goal)])
        poses = recorded.record["pose"]
        for x, y in (goal, *poses[:, :2]):
            assert left + 1.0 < x < right - 1.0
            assert bottom + 1.0 < y < top - 1.0


def test_way_driven_and_contacts_until_then_are_drawn(recorded):
    stamp = recorded.record["stamp"]
    middle = recorded.record["pose"][len(stamp) // 2, :2] + (0.0, 1.0)
    touched = changed(recorded, contact_stamp=np.array([stamp[-2]]), contact_position=middle[None])
    moments = EpisodeStills(touched, 300)
    first, last = moments.at(0.0), moments.at(float(stamp[-1]))
    red = [int((np.abs(frame.astype(int) - (215, 38, 61)).max(axis=2) < 12).sum()) for frame in (first, last)]
    blue = [int((np.abs(frame.astype(int) - (0, 114, 178)).max(axis=2) < 12).sum()) for frame in (first, last)]
    assert red[0] == 0 < red[1]
    assert blue[1] > 1.5 * blue[0]


def test_small_robot_is_drawn_large_enough_to_be_seen(recorded):
    far = changed(recorded, goal=[120.0, 4.0])
    frame = EpisodeStills(far, 300).at(0.0)
    blue = np.argwhere(np.abs(frame.astype(int) - (0, 114, 178)).max(axis=2) < 60)
    assert 9 <= max(np.ptp(blue, axis=0)) <= 20


def test_doors_are_in_the_document_and_shown_as_they_were(recorded):
    rows, leaf = len(recorded.record["stamp"]), [[3.0, 3.0], [4.0, 3.0], [4.0, 3.3], [3.0, 3.3]]
    states = (np.arange(rows) >= rows // 2)[:, None]
    with_door = changed(
        recorded, doors=[{"vertices_xy": leaf, "open": [[1.0, None]], "period": None}], doors_open=states
    )
    header, arrays = read_document(replay_document([with_door]))
    assert header["episodes"][0]["doors"] == [leaf]
    assert (arrays[0, "doors_open"] == states).all()
    moments = EpisodeStills(with_door, 300, (0.0, 8.0, 0.0, 8.0))
    brown = [
        int((np.abs(moments.at(stamp).astype(int) - (0x6D, 0x4C, 0x41)).max(axis=2) < 12).sum())
        for stamp in (0.0, moments.end)
    ]
    assert brown[0] > 300 > 3 * brown[1]
    assert "doors" not in read_document(replay_document([recorded]))[0]["episodes"][0]


def test_member_of_a_switch_that_drives_is_named(recorded):
    events = [{"stamp": 0.0, "kind": "driver", "detail": "teb"}, {"stamp": 0.5, "kind": "driver", "detail": "rosnav"}]
    moments = EpisodeStills(changed(recorded, events=events), 200, title="aio")
    assert [moments._title_text(stamp) for stamp in (0.0, 0.4, 0.5, 3.0)] == [
        "aio (teb)",
        "aio (teb)",
        "aio (rosnav)",
        "aio (rosnav)",
    ]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), r"arguments are none; allowed: arena replay RUN"),
        (("run", "--to", "a.avi"), r"out is a\.avi; allowed: a name that ends in \.html, \.mp4"),
        (("run", "x"), r"EPISODE is 'x'; allowed"),
        (("run", "rate=0"), r"rate is 0"),
        (("run", "live=maybe"), r"live is 'maybe'; allowed"),
    ],
)
def test_a_wrong_request_is_one_line(words, message):
    with pytest.raises(ConfigurationError, match=message):
        read_request(words)


def test_an_episode_that_is_not_there_is_one_line(folder):
    with pytest.raises(ConfigurationError, match=r"EPISODE is 7; allowed: 0, 1"):
        read_recorded(folder, 7)


def test_a_port_that_is_taken_is_one_line(server):
    with pytest.raises(arena.ArenaError, match=r"port \d+: .*; allowed: a free port"):
        PageServer("", b"", urlsplit(server.address).port)


@pytest.fixture(scope="module")
def team_run(tmp_path_factory):
    """A run of three robots that meet in the middle of a room."""
    folder = tmp_path_factory.mktemp("team")
    words = ["task=antipodal", "task.team=3", "task.radius=1.2", "task.time_limit=5", "world=empty", "world.width=6"]
    brain = ["planner=pure_pursuit", "localizer=ground_truth", "pedestrians=none"]
    arena.run([*words, "world.height=6", *brain, "episodes=1", "executor=serial", "report=false"], folder)
    return folder


def test_document_of_a_team_has_the_teammates_at_each_control_step(team_run):
    one = read_recorded(team_run, 1)
    _, arrays = read_document(replay_document([one]))
    steps = len(one.record["stamp"])
    assert arrays[0, "team"].shape == (steps, 2, 3)
    own = one.record["team_pose"]
    assert arrays[0, "team"][:, 0] == pytest.approx(own[:steps, 0], abs=0.0006)
    assert arrays[0, "team"][:, 1] == pytest.approx(own[:steps, 2], abs=0.0006)


def test_pictures_of_a_team_have_each_robot_in_a_colour_of_its_own(team_run):
    pictures = EpisodeStills(read_recorded(team_run, 1), 200)
    first, last = pictures.at(0.0), pictures.at(pictures.end)
    for colour in ("#0072B2", "#8E44AD", "#117A65"):
        channels = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
        shown = [(picture == channels).all(axis=2) for picture in (first, last)]
        assert all(each.sum() > 40 for each in shown)
        assert (shown[0] != shown[1]).any()  # it has moved
