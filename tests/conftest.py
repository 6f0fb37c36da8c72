"""Fixtures: the command line within this process, and small third-party packages made on the spot."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from textwrap import dedent

import pytest
from hypothesis import HealthCheck, settings

from arena_core.cli import main
from arena_core.run import _benchmark, _registry

settings.register_profile("suite", derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
settings.load_profile("suite")

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"


@dataclass(frozen=True)
class Answer:
    """What a command said: exit status, standard output, and the lines of standard error."""

    status: int
    out: str
    errors: list[str]

    @property
    def line(self) -> str:
        """Return the one line of standard error; fail when there are more or fewer."""
        assert len(self.errors) == 1, self.errors
        return self.errors[0]


@pytest.fixture
def arena(capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Callable[..., Answer]]:
    """Call ``arena WORDS...`` in this process, from an empty folder."""
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    monkeypatch.setenv("HYDRA_FULL_ERROR", "1")  # the command sets it: let pytest take it back afterwards

    def call(*words: object) -> Answer:
        _forget_plugins()
        capfd.readouterr()
        status = main([str(word) for word in words])
        out, err = capfd.readouterr()
        return Answer(status, out, err.splitlines())

    yield call
    _forget_plugins()


def _forget_plugins() -> None:
    _registry.cache_clear()
    _benchmark.cache_clear()


@dataclass(frozen=True)
class ThirdParty:
    """A folder on the module search path, for packages that look installed."""

    folder: Path

    def package(self, name: str, module: str, conf: Mapping[str, str] | None = None, version: str = "1.2.3") -> None:
        """Write a plugin package with its distribution's metadata; ``conf`` maps group/option to YAML."""
        self.write(f"{name}/__init__.py", module)
        self.write(f"{name}-{version}.dist-info/METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
        self.write(f"{name}-{version}.dist-info/entry_points.txt", f"[arena]\n{name} = {name}\n")
        if conf is not None:
            self.write(f"{name}/conf/__init__.py", "")
        for option, text in (conf or {}).items():
            self.write(f"{name}/conf/{option}.yaml", text)

    def write(self, path: str, text: str) -> None:
        """Write one file below the folder."""
        (self.folder / path).parent.mkdir(parents=True, exist_ok=True)
        (self.folder / path).write_text(dedent(text))

    @property
    def environment(self) -> dict[str, str]:
        """Return the environment in which another process sees the packages too."""
        return {**os.environ, "PYTHONPATH": str(self.folder)}


@pytest.fixture
def third_party(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ThirdParty]:
    """Offer an empty site folder to write third-party packages into."""
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", str(folder))
    yield ThirdParty(folder)
    for name in [n for n, m in sys.modules.items() if str(getattr(m, "__file__", "") or "").startswith(str(folder))]:
        del sys.modules[name]


@pytest.fixture(scope="session")
def data() -> Path:
    """Return the folder of real maps, scenarios and recordings; skip where it is not present."""
    if not DATA.is_dir():
        pytest.skip(f"real data is not there: {DATA}")
    return DATA
