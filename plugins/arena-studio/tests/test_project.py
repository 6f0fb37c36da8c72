"""The project folder: paths stay inside it, files are written whole, and no one's change is overwritten."""

from __future__ import annotations

from pathlib import Path
from threading import Thread

import pytest

from arena_core import ArenaError, InputFileError
from arena_studio.errors import Conflict, Missing, TooLarge
from arena_studio.project import LARGEST, Project, version_of

OUTSIDE = (
    *("", ".", "..", "../a", "a/../../b", "/etc/passwd", "a/./../..", "C:\\a", "a\\..\\b", "a\0b", "a\nb", "~/../.."),
    *(".git/config", "a/.ssh/x", "${oc.env:HOME}", "a/${hydra:runtime.cwd}/b.yaml"),
)


@pytest.fixture
def project(folder: Path) -> Project:
    return Project(folder)


@pytest.mark.parametrize("path", [*OUTSIDE, "x" * 5000, "/".join("x" * 200)])
def test_path_out_of_the_folder_is_refused(project: Project, path: str) -> None:
    for act in (project.path, project.read, lambda path: project.write(path, b"", None)):
        with pytest.raises(ArenaError):
            act(path)
    assert list(project.root.parent.rglob("*")) == [project.root]


def test_links_out_of_the_folder_are_refused(project: Project) -> None:
    outside = project.root.parent / "outside"
    outside.mkdir()
    (outside / "secret.yaml").write_text("secret")
    (project.root / "folder").symlink_to(outside)
    (project.root / "file.yaml").symlink_to(outside / "secret.yaml")
    (project.root / "round").symlink_to(project.root / "round")
    for path in ("folder/secret.yaml", "file.yaml", "folder", "folder/new.yaml", "round/a"):
        with pytest.raises(ArenaError):
            project.read(path)
        with pytest.raises(ArenaError):
            project.write(path, b"mine", None)
    assert [path.name for path in outside.iterdir()] == ["secret.yaml"]


def test_written_file_is_read_with_its_version(project: Project) -> None:
    version = project.write("maps/hall/map.yaml", b"a: 1\n", None)
    document = project.read("maps/hall/map.yaml")
    assert document.content == b"a: 1\n"
    assert document.version == version == version_of(b"a: 1\n")
    assert project.write("maps/hall/map.yaml", b"a: 2\n", version) == version_of(b"a: 2\n")


def test_change_of_somebody_else_is_not_overwritten(project: Project) -> None:
    version = project.write("a.json", b"1", None)
    (project.root / "a.json").write_bytes(b"theirs")
    for known in (version, None):
        with pytest.raises(Conflict):
            project.write("a.json", b"mine", known)
    (project.root / "a.json").unlink()
    with pytest.raises(Conflict, match="was removed"):
        project.write("a.json", b"mine", version)
    assert not (project.root / "a.json").exists()


def test_of_writers_with_one_version_one_is_taken(project: Project) -> None:
    version = project.write("a.json", b"0", None)
    taken: list[int] = []

    def write(number: int) -> None:
        try:
            project.write("a.json", str(number).encode(), version)
            taken.append(number)
        except Conflict:
            pass

    threads = [Thread(target=write, args=(number,)) for number in range(1, 9)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(taken) == 1
    assert project.read("a.json").content == str(taken[0]).encode()


def test_missing_file_folders_and_large_content_are_told(project: Project) -> None:
    (project.root / "folder").mkdir()
    with pytest.raises(Missing):
        project.read("nothing.yaml")
    with pytest.raises(Missing):
        project.read("folder")
    with pytest.raises(ArenaError, match="is no file"):
        project.write("folder", b"", None)
    with pytest.raises(TooLarge):
        project.write("a.bin", bytes(LARGEST + 1), None)
    with pytest.raises(InputFileError):
        Project(project.root / "nothing")


def test_files_are_the_users_own(project: Project) -> None:
    ours = ("outputs/run/episodes.csv", "outputs/run/worlds/w.yaml", ".hidden/x.yaml", "b/.x.yaml")
    for name in ("b/map.yaml", "a.json", "c.txt", "outputs/y.yaml", *ours):
        path = project.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    assert project.files((".yaml", ".json")) == ["a.json", "b/map.yaml", "outputs/y.yaml"]
