import importlib
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import arena_kernels.compiled
from arena_kernels.compiled import borrowing, compiled, inner, stamp


@inner
def first_of(values):
    return values[0]


@borrowing
def twice_the_first(values):
    return 2.0 * first_of(values)


@borrowing
def sum_of_a_copy(values):
    return values.copy().sum()


def test_kernels_call_inner_kernels_and_python_cannot():
    assert twice_the_first(np.array([3.0, 4.0])) == 6.0
    with pytest.raises(TypeError, match="only other kernels can call it"):
        first_of(np.array([3.0]))


def test_borrowing_kernel_that_makes_an_array_is_refused():
    with pytest.raises(Exception, match="NRT"):
        sum_of_a_copy(np.array([3.0]))


def test_division_by_zero_does_not_raise():
    @compiled
    def quotient(a, b):
        return a / b

    assert quotient(1.0, 0.0) == np.inf


def test_kernel_is_compiled_anew_when_one_that_it_calls_has_changed(tmp_path, monkeypatch):
    """numba alone would go on calling the old one: it looks at the caller's own file."""
    package = tmp_path / "sample_kernels"
    package.mkdir()
    (package / "__init__.py").write_text("")
    caller = "from arena_kernels.compiled import compiled\nfrom sample_kernels.called import value\n\n"
    caller += "@compiled\ndef call(): return value()\n"
    (package / "caller.py").write_text(caller)
    monkeypatch.syspath_prepend(tmp_path)
    answers = []
    for number in (1, 22):
        source = f"""
            from arena_kernels.compiled import compiled

            @compiled
            def value(): return {number}
            """
        (package / "called.py").write_text(textwrap.dedent(source))
        for name in [name for name in sys.modules if name.startswith("sample_kernels")]:
            monkeypatch.delitem(sys.modules, name)
        importlib.invalidate_caches()
        answers.append(importlib.import_module("sample_kernels.caller").call())
        stamp.cache_clear()
    assert answers == [1, 22]


@pytest.fixture
def kernel_of_others(tmp_path, monkeypatch):
    """A kernel in a package of its own, and what starts another process that calls it and says what came out and whether it was loaded."""
    source = "from arena_kernels.compiled import compiled\n\n@compiled\ndef double(x): return 2 * x\n"
    (tmp_path / "kernels_of_others.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    told = "from kernels_of_others import double; print(double(4), sum(double._cache_hits.values()))"
    words = [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(tmp_path)!r}); {told}"]
    kernel = importlib.import_module("kernels_of_others").double
    yield kernel, lambda: subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    del sys.modules["kernels_of_others"]


def test_kernel_that_another_process_compiles_is_waited_for_and_loaded(kernel_of_others):
    kernel, start = kernel_of_others
    with kernel._cache.alone():
        other = start()
        with pytest.raises(subprocess.TimeoutExpired):
            other.wait(4.0)
        assert kernel(1) == 2  # compiled here, and kept
    assert other.communicate(timeout=60)[0].split() == ["8", "1"]


def test_process_goes_on_alone_where_the_one_that_compiles_is_suspended(kernel_of_others, monkeypatch):
    kernel, start = kernel_of_others
    assert start().communicate(timeout=60)[0].split() == ["8", "0"]  # nobody holds it
    monkeypatch.setattr(arena_kernels.compiled, "PATIENCE", 0.1)
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDER.format(folder=kernel._cache.cache_path, index=kernel._cache._cache_file._index_name)],
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

from arena_kernels.compiled import _held, _lock_file

if _held(_lock_file({folder!r}), crc32({index!r}.encode())):
    print("held", flush=True)
sys.stdin.read()
"""
