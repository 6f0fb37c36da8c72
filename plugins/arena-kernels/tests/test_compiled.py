import importlib
import os
import subprocess
import sys

import numpy as np
import pytest

import arena_kernels.compiled
from arena_kernels.compiled import MODE, borrowing, compiled, inner, packages_of
from arena_kernels.sources import sources_digest

BESIDE = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}  # kernels beside their source
ours = pytest.mark.skipif(MODE == "plain", reason="ARENA_KERNELS=plain: numba's own decorators and cache")


@inner
def first_of(values):
    return values[0]


@borrowing
def twice_the_first(values):
    return 2.0 * first_of(values)


@borrowing
def sum_of_a_copy(values):
    return values.copy().sum()


@ours
def test_kernels_call_inner_kernels_and_python_cannot():
    assert twice_the_first(np.array([3.0, 4.0])) == 6.0
    with pytest.raises(TypeError, match="only other kernels can call it"):
        first_of(np.array([3.0]))


@ours
def test_borrowing_kernel_that_makes_an_array_is_refused():
    with pytest.raises(Exception, match="NRT"):
        sum_of_a_copy(np.array([3.0]))


def test_division_by_zero_does_not_raise():
    @compiled
    def quotient(a, b):
        return a / b

    assert quotient(1.0, 0.0) == np.inf


CALLED = "from arena_kernels.compiled import compiled\n\n@compiled\ndef value(): return {number}\n"
BETWEEN = (
    "from arena_kernels.compiled import compiled\nfrom {called} import value\n\n@compiled\ndef passed(): "
    "return value()\n"
)
CALLER = (
    "from arena_kernels.compiled import compiled\nfrom {called} import passed\n\n@compiled\ndef call(): "
    "return passed()\n"
)


LAYOUTS = [  # modules of the called kernel, of one between, of the caller
    ("flat.called", "flat.between", "flat.caller"),
    ("deep.shelf.called", "deep.shelf.between", "deep.caller"),
    ("package_a.called", "package_b.between", "package_c.caller"),
    ("module_called", "module_between", "module_caller"),
]


def write_layouts(top, number):
    for called, between, caller in LAYOUTS:
        texts = {
            called: CALLED.format(number=number),
            between: BETWEEN.format(called=called),
            caller: CALLER.format(called=between),
        }
        for module, text in texts.items():
            path = top / (module.replace(".", "/") + ".py")
            path.parent.mkdir(parents=True, exist_ok=True)
            for folder in (path.parent, *path.parent.parents):
                if folder != top and top in folder.parents:
                    (folder / "__init__.py").touch()
            path.write_text(text)


@pytest.mark.slow
@ours
def test_a_kernel_is_compiled_anew_when_one_that_it_stands_on_has_changed_wherever_that_is(tmp_path):
    """numba alone would go on calling the old one: it looks at the caller's own file."""
    told = "import sys, importlib\nfor name in sys.argv[1:]: call = importlib.import_module(name).call; "
    told += "print(call(), sum(call.stats.cache_hits.values()))"
    words = [sys.executable, "-c", told, *(caller for *_, caller in LAYOUTS)]
    answers = []
    for number in (1, 22, 22):
        write_layouts(tmp_path, number)
        env = {**BESIDE, "PYTHONPATH": str(tmp_path)}
        answers.append(subprocess.run(words, capture_output=True, text=True, check=True, env=env).stdout.splitlines())
    assert answers == [["1 0"] * len(LAYOUTS), ["22 0"] * len(LAYOUTS), ["22 1"] * len(LAYOUTS)]


@pytest.mark.slow
@ours
def test_places_with_the_same_sources_share_the_kernels_of_a_given_folder_and_others_do_not(tmp_path):
    told = "from sample.caller import call; print(call(), sum(call.stats.cache_hits.values()))"
    answers = []
    for place, number in (("here", 1), ("there", 1), ("elsewhere", 22), ("here", 1)):
        package = tmp_path / place / "sample"
        package.mkdir(parents=True, exist_ok=True)
        (package / "__init__.py").touch()
        (package / "caller.py").write_text(CALLED.format(number=number).replace("value", "call"))
        where = {**BESIDE, "PYTHONPATH": str(package.parent), "NUMBA_CACHE_DIR": str(tmp_path / "kernels")}
        words = {"capture_output": True, "text": True, "check": True, "env": where}
        answers.append(subprocess.run([sys.executable, "-c", told], **words).stdout.split())
    assert answers == [["1", "0"], ["1", "1"], ["22", "0"], ["1", "1"]]


@ours
def test_touched_files_and_other_packages_leave_kernels_on_disk_as_they_are(tmp_path):
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("x = 1\n")
    before = sources_digest(tmp_path / "one")
    os.utime(tmp_path / "one" / "__init__.py", (1.0, 1.0))
    (tmp_path / "other" / "__init__.py").write_text("x = 2\n")
    sources_digest.cache_clear()
    assert sources_digest(tmp_path / "one") == before
    (tmp_path / "one" / "__init__.py").write_text("x = 3\n")
    sources_digest.cache_clear()
    assert sources_digest(tmp_path / "one") != before


@ours
def test_a_kernel_stands_on_its_package_this_one_and_those_of_kernels_that_its_module_has():
    module = importlib.import_module("arena_mujoco.ticking")
    names = {folder.name for folder in packages_of(module.before_tick.py_func)}
    assert {"arena_mujoco", "arena_kernels"} <= names <= {"arena_mujoco", "arena_kernels", "arena_sim2d"}


@pytest.mark.parametrize(
    ("mode", "kind"), [("plain", "CPUDispatcher"), ("native", "KernelDispatcher"), ("checked", "KernelDispatcher")]
)
def test_the_environment_chooses_numbas_own_decorators(mode, kind):
    told = "from arena_kernels import distance; from numba.core.dispatcher import Dispatcher;"
    told += "print(*{type(value).__name__ for value in vars(distance).values() if isinstance(value, Dispatcher)})"
    words = {"capture_output": True, "text": True, "check": True, "env": {**os.environ, "ARENA_KERNELS": mode}}
    assert subprocess.run([sys.executable, "-c", told], **words).stdout.split() == [kind]


def test_another_way_to_compile_is_refused_in_one_line():
    told = subprocess.run(
        [sys.executable, "-c", "import arena_kernels.compiled"],
        capture_output=True,
        env={**os.environ, "ARENA_KERNELS": "x"},
    )
    assert (
        told.stderr.decode().splitlines()[-1]
        == "ValueError: ARENA_KERNELS is 'x'; allowed: fast, native, checked, plain"
    )


@pytest.fixture
def kernel_of_others(tmp_path, monkeypatch):
    """A kernel in a package of its own, and what starts another process that calls it and says what came
    out and whether it was loaded.
    """
    source = "from arena_kernels.compiled import compiled\n\n@compiled\ndef double(x): return 2 * x\n"
    (tmp_path / "kernels_of_others.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(arena_kernels.compiled.numba_config, "CACHE_DIR", "")
    told = "from kernels_of_others import double; print('asks', flush=True); "
    told += "print(double(4), sum(double.stats.cache_hits.values()))"
    words = [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(tmp_path)!r}); {told}"]
    kernel = importlib.import_module("kernels_of_others").double
    yield kernel, lambda: subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=BESIDE)
    del sys.modules["kernels_of_others"]


@pytest.mark.slow
@ours
def test_kernel_that_another_process_compiles_is_waited_for_and_loaded(kernel_of_others):
    kernel, start = kernel_of_others
    with kernel.lock_kernel():
        other = start()
        assert other.stdout.readline() == "asks\n"
        with pytest.raises(subprocess.TimeoutExpired):
            other.wait(1.0)
        assert kernel(1) == 2  # compiled here, and kept
    assert other.communicate(timeout=600)[0].split() == ["8", "1"]


@pytest.mark.slow
@ours
def test_process_goes_on_alone_where_the_one_that_compiles_is_suspended(kernel_of_others, monkeypatch):
    kernel, start = kernel_of_others
    assert start().communicate(timeout=600)[0].split() == ["asks", "8", "0"]  # no one holds it
    monkeypatch.setattr(arena_kernels.compiled, "PATIENCE", 0.1)
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDER.format(folder=kernel.stats.cache_path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert holder.stdout.readline() == "held\n"
    assert kernel(3.0) == 6.0
    holder.communicate("")


HOLDER = """
import sys
from zlib import crc32

from arena_kernels.compiled import held, lock_file

if held(lock_file({folder!r}), crc32(b"kernels_of_others.double")):
    print("held", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def unwritable(tmp_path):
    """A module whose kernels no folder takes: a file is in the place of each folder."""
    (tmp_path / "unkept.py").write_text(
        "from arena_kernels.compiled import compiled\n\n@compiled\ndef double(x): return 2.0 * x\n"
    )
    (tmp_path / "__pycache__").write_text("")
    return {**BESIDE, "PYTHONPATH": str(tmp_path), "HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null/cache"}


@ours
def test_kernels_are_compiled_and_not_kept_where_nothing_can_be_written(unwritable):
    code = "import unkept; print(unkept.double(3.0))"
    ran = subprocess.run([sys.executable, "-c", code], env=unwritable, capture_output=True, text=True, timeout=600)
    assert (ran.stdout, ran.returncode) == ("6.0\n", 0), ran.stderr
    assert ran.stderr.count("kernels are not kept") == 1
    assert "NUMBA_CACHE_DIR names another folder" in ran.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no limit on the size of files")
@ours
def test_a_kernel_is_called_where_the_disk_is_full(unwritable, tmp_path):
    code = (
        "import resource, unkept\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (9, 9))  # bytes: the first kernel is refused as by a full disk\n"
        "print(unkept.double(3.0))"
    )
    given = {**unwritable, "NUMBA_CACHE_DIR": str(tmp_path / "kernels")}
    ran = subprocess.run([sys.executable, "-c", code], env=given, capture_output=True, text=True, timeout=600)
    assert (ran.stdout, ran.returncode) == ("6.0\n", 0), ran.stderr
    assert "File too large" in ran.stderr
