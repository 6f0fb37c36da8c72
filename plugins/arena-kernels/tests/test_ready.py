import json
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import arena_kernels
from arena_kernels.ready import (
    CHOSEN,
    CPU,
    CPU_FEATURES,
    TARGETS,
    choose_target,
    has_native,
    manifest_of,
    note_native,
    processor_flags,
    read_manifest,
    reason_against,
    write_manifest,
)

V3 = TARGETS["x86_64"]
FLAGS = frozenset(V3.flags)


@pytest.fixture
def before_numba(monkeypatch):
    """As in a process that has not imported numba."""
    monkeypatch.delitem(sys.modules, "numba", raising=False)


@pytest.fixture
def manifest(before_numba):
    return manifest_of(V3)


def test_ready_made_kernels_of_the_same_sources_and_versions_are_used_on_a_processor_that_can(manifest):
    assert reason_against(manifest, {}, FLAGS) == ""
    assert reason_against(manifest, {}, FLAGS | {"avx512f"}) == ""


@pytest.mark.parametrize("change", [{"numba": "0.1"}, {"python": "cpython-312"}, {"sources": "x"}, {"platform": "x"}])
def test_other_versions_and_sources_compile_as_ever(manifest, change):
    assert "other versions" in reason_against(replace(manifest, **change), {}, FLAGS)


@pytest.mark.parametrize("flag", V3.flags)
def test_a_processor_that_lacks_something_compiles_as_ever(manifest, flag):
    assert reason_against(manifest, {}, FLAGS - {flag}) == f"this processor lacks {flag}"


@pytest.mark.parametrize(
    ("environ", "reason"),
    [
        ({"ARENA_KERNELS": "native"}, "ARENA_KERNELS is native"),
        ({"ARENA_KERNELS": "plain"}, "ARENA_KERNELS is plain"),
        ({CPU: "generic"}, "NUMBA_CPU_NAME or NUMBA_CPU_FEATURES is set"),
        ({CPU_FEATURES: ""}, "NUMBA_CPU_NAME or NUMBA_CPU_FEATURES is set"),
        ({CHOSEN: "none"}, "the process that has started this one uses none"),
    ],
)
def test_who_says_otherwise_is_heard(manifest, environ, reason):
    assert reason_against(manifest, environ, FLAGS) == reason


def test_where_numba_has_read_its_settings_kernels_are_compiled(manifest, monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", object())
    assert reason_against(manifest, {}, FLAGS) == "numba was imported before"


def test_a_process_and_its_children_compile_for_one_processor(before_numba, tmp_path, monkeypatch):
    manifest = write_manifest(tmp_path, V3)
    assert read_manifest(tmp_path) == manifest
    monkeypatch.setattr("arena_kernels.ready.processor_flags", lambda: FLAGS)
    environ = {}
    assert choose_target(tmp_path, environ) == ""
    assert environ == {CPU: "x86-64-v3", CPU_FEATURES: V3.features, CHOSEN: manifest.digest}
    monkeypatch.setitem(sys.modules, "numba", object())
    assert choose_target(tmp_path, environ) == ""  # a child is told
    refused = {CPU: "generic"}
    assert choose_target(tmp_path, refused)
    assert refused == {CPU: "generic", CHOSEN: "none"}


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"flags": 1}', '{"cpu": "x86-64-v3"}', "\0"])
def test_without_a_manifest_that_can_be_read_nothing_changes(tmp_path, text):
    environ = {}
    assert choose_target(tmp_path, environ) == "there are none"
    (tmp_path / "ready.json").write_text(text)
    assert choose_target(tmp_path, environ) == "there are none"
    assert environ == {}


def test_kernels_that_were_compiled_for_this_very_processor_replace_ready_made_ones(manifest, tmp_path):
    environ = {"NUMBA_CACHE_DIR": str(tmp_path / "kernels")}
    assert not has_native(manifest, FLAGS, environ)
    assert note_native(manifest, FLAGS, environ) == tmp_path / "kernels" / "native.txt"
    assert reason_against(manifest, environ, FLAGS) == "kernels were compiled for this processor"
    assert reason_against(manifest, environ, FLAGS | {"avx512f"}) == ""  # another machine with the same folder
    assert not has_native(replace(manifest, sources="changed"), FLAGS, environ)


def test_flags_are_those_that_linux_tells(tmp_path):
    (tmp_path / "cpuinfo").write_text("processor\t: 0\nflags\t\t: fpu avx2 fma\n\nprocessor\t: 1\nflags\t\t: fpu\n")
    assert processor_flags(tmp_path / "cpuinfo") == {"fpu", "avx2", "fma"}
    assert processor_flags(tmp_path / "none") == frozenset()


KERNEL = "from arena_kernels.compiled import compiled\n\n@compiled\ndef double(x): return x + x\n"
CALL = (
    "from arena_kernels.ready import choose_target; reason = choose_target()\n"
    "from sample import double; from numba.core import config\n"
    "print(double(2.5), sum(double.stats.cache_hits.values()), config.CPU_NAME, reason, sep=';')"
)


@pytest.mark.slow
@pytest.mark.skipif(not processor_flags().issuperset(FLAGS), reason="a processor without what x86-64-v3 has")
def test_a_first_call_compiles_nothing_where_kernels_came_ready_made(tmp_path):
    """Once with nowhere to write but a folder of its own, once with another numba's manifest."""
    place = tmp_path / "installed"
    leave = shutil.ignore_patterns("__pycache__", "ready")
    shutil.copytree(Path(arena_kernels.__file__).parent, place / "arena_kernels", ignore=leave)
    (place / "sample.py").write_text(KERNEL)
    ready = place / "arena_kernels" / "ready"
    plain = {k: v for k, v in os.environ.items() if k not in (CPU, CPU_FEATURES, CHOSEN, "ARENA_KERNELS")}

    def call(kernels, **environ):
        words = [sys.executable, "-c", CALL]
        env = {**plain, "PYTHONPATH": str(place), "NUMBA_CACHE_DIR": str(kernels), **environ}
        return subprocess.run(words, env=env, capture_output=True, text=True, check=True).stdout.strip().split(";")

    made = call(ready, ARENA_KERNELS="native", **{CPU: V3.cpu, CPU_FEATURES: V3.features})
    assert made == ["5.0", "0", "x86-64-v3", "there are none"]
    manifest = write_manifest(ready, V3)
    assert call(tmp_path / "empty") == ["5.0", "1", "x86-64-v3", ""]
    (ready / "ready.json").write_text(json.dumps({**json.loads((ready / "ready.json").read_text()), "numba": "0.1"}))
    assert call(tmp_path / "empty")[1:3] == ["0", "None"]
    assert manifest.cpu == V3.cpu
