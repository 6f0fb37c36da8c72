"""Seasons: a seed from a beacon's value, entries that are published before it, crowds alone."""

from dataclasses import replace
from datetime import UTC, date, datetime

import pytest

import arena_submit.standing
from arena_core import ConfigurationError, InputFileError
from arena_core import run as run_benchmark
from arena_submit.commands import LeaderboardCommand, SubmitCommand
from arena_submit.seasons import Entries, Published, open_season, published_text, read_entries, season_seed
from arena_submit.standing import read_standing

V2 = read_standing("arena_v2")
VALUE = "0f" * 32
GENESIS, PERIOD = 1692803367, 3  # s, of drand's quicknet


def test_the_round_is_that_of_the_day_on_which_the_season_opens():
    for season in V2.seasons.values():
        opens = datetime.fromisoformat(season.opens).replace(tzinfo=UTC)
        assert (opens.timestamp() - GENESIS) / PERIOD + 1.0 == season.round
    assert "chain 52db9ba70e0cc0f6" in V2.beacon


def test_a_seed_is_of_benchmark_season_and_value_alone():
    found = season_seed("arena_v2", "spring_2027", VALUE)
    assert found == 1737019947  # printf 'arena_v2 spring_2027 0f…' | sha256sum
    assert (
        len({found, season_seed("arena_v2", "autumn_2027", VALUE), season_seed("arena_v2", "spring_2027", "00" * 32)})
        == 3
    )
    assert 0 <= found < 2**31


def test_a_season_has_the_crowds_alone():
    sealed = open_season(V2, "spring_2027", f" {VALUE.upper()} ")
    assert (sealed.standing.seed, sealed.standing.problems) == (season_seed("arena_v2", "spring_2027", VALUE), 504)
    assert list(sealed.standing.tables) == ["arena_v2/"]
    assert sealed.opens == date(2027, 3, 1)


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("autumn", VALUE, "season is autumn; allowed: spring_2027"),
        ("spring_2027", "12", "value is 12; allowed: the 64 hexadecimal digits of round 37018612 of drand quicknet"),
        ("spring_2027", "g" * 64, "allowed: the 64 hexadecimal digits"),
    ],
)
def test_what_is_no_season_is_refused(name, value, said):
    with pytest.raises(ConfigurationError, match=said):
        open_season(V2, name, value)


def test_an_entry_is_late_unless_it_was_published_before_the_day():
    entries = Entries(
        "a list", [Published("ab", "2027-02-28"), Published("cd", "2027-03-01"), Published("ab", "2027-05-01")]
    )
    opens = date(2027, 3, 1)
    assert [published_text(entry, entries, opens) for entry in ("ab", "cd", "ef")] == ["2027-02-28", "late", "late"]
    assert published_text("ab", None, opens) == "late"


def test_a_day_that_is_none_is_named(tmp_path):
    path = tmp_path / "entries.yaml"
    path.write_text("where: here\nentries:\n- {entry: ab, published: '2027-02-30'}\n")
    with pytest.raises(InputFileError, match=r"entries\.yaml: published is 2027-02-30; allowed: YYYY-MM-DD"):
        read_entries(path)


def test_a_day_may_be_without_quotes(tmp_path):
    path = tmp_path / "entries.yaml"
    path.write_text("where: here\nentries:\n- {entry: ab, published: 2027-02-28}\n")
    assert read_entries(path) == Entries("here", [Published("ab", "2027-02-28")])


def test_a_season_is_driven_packed_and_ranked_and_says_who_was_published(tmp_path, monkeypatch, capsys):
    small = replace(V2, episodes=1, robots=["jackal"], scenarios={"arena_v2/hall_00": ""})
    monkeypatch.setattr(arena_submit.standing, "read_standing", lambda name: small)
    assert LeaderboardCommand().run(["season", "spring_2027", f"value={VALUE}", "planner=pure_pursuit"]) == 0
    opens, entry, drive, submit = capsys.readouterr().out.splitlines()
    assert opens.startswith("spring_2027 opens on 2027-03-01 at 0:00 UTC with round 37018612 of drand")
    words = [word for word in drive.split()[2:] if not word.startswith("out=")]
    more = ["robot=jackal", "scenario=arena_v2/hall_00", "episodes=1", "executor=serial"]
    run_benchmark([*words, *more], tmp_path / "run")
    submitted = [str(tmp_path / "run"), *submit.split()[3:-1], f"out={tmp_path}/pack.zip"]
    assert SubmitCommand().run(submitted) == 0
    entries = tmp_path / "entries.yaml"
    entries.write_text(f"where: a list\nentries:\n- {{entry: {entry.split()[1]}, published: '2027-02-01'}}\n")
    season = ["season=spring_2027", f"value={VALUE}"]
    assert (
        LeaderboardCommand().run([f"{tmp_path}/pack.zip", *season, f"entries={entries}", f"out={tmp_path}/a.md"]) == 0
    )
    lines = (tmp_path / "a.md").read_text().splitlines()
    assert lines[0] == "# Leaderboard: arena_v2, season spring_2027"
    assert lines[lines.index("## Entries") + 7].endswith(f"| {entry.split()[1]} | 2027-02-01 |")
    with pytest.raises(
        InputFileError, match=r"has seed 7200000 and 1 episodes|has seed \d+ and 1 episodes, not 7200000"
    ):
        LeaderboardCommand().run([f"{tmp_path}/pack.zip"])
    with pytest.raises(ConfigurationError, match=r"entries is .*; allowed with season=NAME value=HEX"):
        LeaderboardCommand().run([f"{tmp_path}/pack.zip", f"entries={entries}"])
