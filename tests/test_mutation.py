"""Which faults benchmarks/mutation.py plants."""

import ast
import importlib.util
import sys
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[1]


@pytest.fixture
def mutation(monkeypatch):
    spec = importlib.util.spec_from_file_location("mutation", TOP / "benchmarks" / "mutation.py")
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "mutation", module)  # dataclasses look there
    spec.loader.exec_module(module)
    return module


def planted(mutation, source):
    return [one.plant(source.encode()).decode() for one in mutation.find_mutants(source.encode())]


@pytest.mark.parametrize(
    ("source", "others"),
    [
        ("x = a < b", ["x = a <= b", "x = a > b"]),
        ("x = a >= b", ["x = a < b", "x = a > b"]),
        ("x = a == b", ["x = a != b"]),
        ("x = a not in b", ["x = a in b"]),
        ("x = a + b", ["x = a - b"]),
        ("x = a * b - c", ["x = a * b + c", "x = a / b - c"]),
        ("x = a // b", ["x = a * b"]),
        ("x -= a", ["x += a"]),
        ("x = a and b or c", ["x = (a and b) and c", "x = a or b or c"]),
        ("x = not a", ["x = (a)"]),
        ("x = -a", ["x = (a)"]),
        ("x = 0.5", ["x = 0.55"]),
        ("x = 0.0", ["x = 1.0"]),
        ("x = 7", ["x = 8"]),
        ("x = min(a, b)", ["x = max(a, b)"]),
        ("x = np.maximum(a, b)", ["x = np.minimum(a, b)"]),
        ("def f() -> bool:\n    return a", ["def f() -> bool:\n    return not (a)"]),
        ("def f() -> float:\n    return a", ["def f() -> float:\n    return -(a)"]),
    ],
)
def test_one_expression_is_changed_at_a_time(mutation, source, others):
    assert sorted(planted(mutation, source)) == sorted(others)


@pytest.mark.parametrize(
    "source",
    [
        'x = f"{a + 1:.2f}"',
        "raise ValueError(a + 1)",
        "assert a < b",
        "x: Literal[1] = a",
        "@cache(maxsize=16)\ndef f() -> None:\n    pass",
        "x = 'a' + b",
        "x = [a] + b",
        "x = True",
        "def f() -> str:\n    return a",
    ],
)
def test_texts_types_errors_and_decorators_are_left_alone(mutation, source):
    assert planted(mutation, source) == []


def test_every_mutant_of_a_module_is_other_code_that_can_be_parsed(mutation):
    source = (TOP / "arena_core" / "statistics" / "intervals.py").read_bytes()
    whole = ast.dump(ast.parse(source))
    found = mutation.find_mutants(source)
    assert len(found) > 100
    assert all(ast.dump(ast.parse(one.plant(source))) != whole for one in found)
