"""Archives that anybody may have made are read within limits, or refused in one line."""

import stat
import zipfile

import pytest

from arena_core import InputFileError
from arena_submit.archive import open_archive, write_archive
from arena_submit.packing import read_pack, write_pack


def names(path):
    with open_archive(path) as archive:
        return archive.names


def spoilt(path, packed, change):
    """Write the pack's members to ``path``, each as ``change(name, content)`` wants it (None: left out)."""
    with zipfile.ZipFile(packed) as before, zipfile.ZipFile(path, "w") as after:
        for member in before.infolist():
            content = change(member.filename, before.read(member))
            if content is not None:
                after.writestr(member.filename, content)
    return path


def test_a_pack_holds_records_tables_provenance_and_nothing_else(packed):
    kinds = {name.rsplit("/", 2)[-2] for name in names(packed) if name.endswith(".npz")}
    assert kinds == {"records", "timing", "worlds"}
    assert {name for name in names(packed) if not name.endswith(".npz")} == {
        "pack.json",
        "runs/0/episodes.csv",
        "runs/0/provenance.json",
    }


def test_equal_runs_are_equal_packs(finished, packed, tmp_path):
    write_pack([finished, finished.parent], tmp_path / "again.zip")
    assert (tmp_path / "again.zip").read_bytes() == packed.read_bytes()


@pytest.mark.parametrize(
    "name", ["../evil.npz", "/etc/passwd", "runs/0/../../x.csv", "runs/0/records/0000.npz/", "readme.md"]
)
def test_a_name_that_no_pack_has_is_refused(name, tmp_path):
    with zipfile.ZipFile(tmp_path / "bad.zip", "w") as archive:
        archive.writestr(zipfile.ZipInfo(name), b"")
    with pytest.raises(InputFileError, match=r"bad\.zip: .* is (no file of a pack|a link)|cannot be read"):
        names(tmp_path / "bad.zip")


def test_a_link_is_refused(tmp_path):
    link = zipfile.ZipInfo("runs/0/episodes.csv")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(tmp_path / "link.zip", "w") as archive:
        archive.writestr(link, "/etc/passwd")
    with pytest.raises(InputFileError, match=r"episodes\.csv is a link or a device"):
        names(tmp_path / "link.zip")


def test_a_file_that_unpacks_to_too_much_is_refused_before_it_is_unpacked(tmp_path):
    with zipfile.ZipFile(tmp_path / "bomb.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("runs/0/provenance.json", bytes(10_000_001))
    with pytest.raises(InputFileError, match=r"provenance\.json has 10000001 bytes, at most 10000000 are read"):
        names(tmp_path / "bomb.zip")


def test_a_size_that_is_not_true_is_found_out(tmp_path):
    write_archive(tmp_path / "a.zip", {"pack.json": b"0123456789" * 10})
    content = (tmp_path / "a.zip").read_bytes().replace((100).to_bytes(4, "little"), (50).to_bytes(4, "little"))
    (tmp_path / "a.zip").write_bytes(content)
    with (
        open_archive(tmp_path / "a.zip") as archive,
        pytest.raises(InputFileError, match=r"pack\.json (is damaged|has not the size)"),
    ):
        archive.read("pack.json")


def test_a_file_that_is_there_twice_is_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "twice.zip", "w") as archive:
        archive.writestr("pack.json", b"{}")
        with pytest.warns(UserWarning, match="Duplicate"):
            archive.writestr("pack.json", b"{}")
    with pytest.raises(InputFileError, match=r"pack\.json is there twice"):
        names(tmp_path / "twice.zip")


@pytest.mark.parametrize("content", [b"", b"no archive", b"PK\x03\x04"])
def test_what_is_no_archive_is_one_line(content, tmp_path):
    (tmp_path / "x.zip").write_bytes(content)
    with pytest.raises(
        InputFileError, match=r"x\.zip: cannot be read \(.*\); allowed: a file that `arena submit` wrote"
    ):
        names(tmp_path / "x.zip")


def test_a_file_that_was_changed_after_packing_is_named(packed, tmp_path):
    path = spoilt(
        tmp_path / "changed.zip",
        packed,
        lambda name, content: content + b" " if name.endswith("episodes.csv") else content,
    )
    with pytest.raises(InputFileError, match=r"runs/0/episodes\.csv is not as it was packed"), read_pack(path):
        pass


def test_a_file_that_is_missing_is_found_out(packed, tmp_path):
    path = spoilt(
        tmp_path / "less.zip", packed, lambda name, content: None if name.endswith("records/0001.npz") else content
    )
    with pytest.raises(InputFileError, match="holds other files than it says"), read_pack(path):
        pass


def test_a_run_that_is_not_finished_is_not_packed(copied, tmp_path):
    table = copied / "episodes.csv"
    table.write_text("".join(table.read_text().splitlines(keepends=True)[:-1]))
    with pytest.raises(InputFileError, match=r"copied: holds 2 episodes of a run of 3; allowed: finished runs"):
        write_pack([copied], tmp_path / "pack.zip")
    assert not (tmp_path / "pack.zip").exists()


def test_a_link_out_of_a_run_is_not_packed(copied, tmp_path):
    record = copied / "records" / "0000.npz"
    record.rename(tmp_path / "elsewhere.npz")
    record.symlink_to(tmp_path / "elsewhere.npz")
    with pytest.raises(InputFileError, match="leads out of"):
        write_pack([copied], tmp_path / "pack.zip")
