"""The Python scripts beside the packages find what they import: neither a type checker nor another test reads them."""

import ast
import importlib
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).resolve().parents[1] / "scripts"
PYTHON = sorted(
    path for path in SCRIPTS.iterdir() if path.is_file() and path.read_text().startswith("#!/usr/bin/env python3")
)


def imported(script):
    """Yield the modules and names that a script takes from the suite, wherever in it."""
    for node in ast.walk(ast.parse(script.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("arena_"):
            yield from ((node.module, name.name) for name in node.names)


@pytest.mark.parametrize("script", [pytest.param(path, id=path.name) for path in PYTHON])
def test_script_finds_what_it_imports(script):
    for module, name in imported(script):
        assert hasattr(importlib.import_module(module), name), f"{script.name}: {module} has no {name}"


def test_scripts_that_draw_are_among_them():
    assert {"draw_episode", "draw_scenarios", "write_results"} <= {path.name for path in PYTHON}
