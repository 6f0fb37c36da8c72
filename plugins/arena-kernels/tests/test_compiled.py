import importlib
import sys
import textwrap

import numpy as np
import pytest

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
