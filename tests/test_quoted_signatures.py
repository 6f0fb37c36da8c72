"""Signatures and counts that pages quote are those of the code."""

import ast
import fnmatch
import inspect
import re
from functools import cache
from pathlib import Path

import pytest

from arena_core import testing
from arena_core.hosting import load_registry

TOP = Path(__file__).resolve().parents[1]
PAGES = sorted([*TOP.glob("*.md"), *TOP.glob("docs/*.md"), *TOP.glob("plugins/*/README.md")])
QUOTE = re.compile(r"`(?:[\w.]+\.)?(\w+)\(((?:\w+(?:, \w+)*)?)\)`")
OF_PYTHON = {"len"}
OF_OTHERS = {("render", ())}  # gymnasium's
MODULES_OF_OTHERS = {"run.py", "get_metrics.py", "staged_train_callback.py", "task_generator_node.py"}
CALLBACKS = {("compute", ("record",)), ("check", ("job",)), ("work", ("job",))}  # parameters that are functions
NUMBERS = ["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"]


@cache
def sources():
    """Return the text of every module of the tree."""
    return [path.read_text() for path in [*TOP.glob("arena_core/**/*.py"), *TOP.glob("plugins/*/src/**/*.py")]]


@cache
def signatures(name):
    """Return the parameters of every function, method and class of a name: names, and how many have no default."""
    public = getattr(testing, name, None)
    found = [offered_parameters(public)] if callable(public) else []
    for text in sources():
        if f"def {name}(" in text or f"class {name}" in text:
            found += [parameters(node) for node in ast.walk(ast.parse(text)) if getattr(node, "name", None) == name]
    return [parts for parts in found if parts is not None]


def offered_parameters(function):
    """Return the parameters of a public function, which may have another name in its module: names, number required."""
    listed = inspect.signature(function).parameters
    return [*listed], sum(part.default is part.empty for part in listed.values())


def parameters(node):
    """Return the parameters of a function or of a class (its constructor's, or its fields): names, number required."""
    if isinstance(node, ast.ClassDef):
        made = [part for part in node.body if getattr(part, "name", None) == "__init__"]
        fields = [part for part in node.body if isinstance(part, ast.AnnAssign)]
        if made:
            return parameters(made[0])
        return [field.target.id for field in fields], sum(field.value is None for field in fields)
    if not isinstance(node, ast.FunctionDef):
        return None
    names = [arg.arg for arg in node.args.args if arg.arg not in ("self", "cls")]
    return names, len(names) - len(node.args.defaults)


def is_right(name, quoted):
    """Return whether some function of the tree can be called with these names of parameters, in this order."""
    wanted = [word for word in quoted.split(", ") if word not in ("", "self")]
    if name in OF_PYTHON or (name, tuple(wanted)) in OF_OTHERS | CALLBACKS:
        return True
    return any(names[: len(wanted)] == wanted and len(wanted) >= required for names, required in signatures(name))


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(TOP)))
def test_every_quoted_call_has_the_parameters_of_the_code(path):
    quoted = QUOTE.findall(path.read_text())
    assert [f"{name}({words})" for name, words in quoted if not is_right(name, words)] == []


def test_a_call_that_has_drifted_is_found():
    assert is_right("step", "crowd, robots, ticks, dt")
    assert not is_right("step", "people, robots, worlds, dt")
    assert not is_right("no_such_function", "")


@pytest.mark.parametrize("kind", ["executor", "command"])
def test_the_page_counts_what_the_core_offers(kind):
    text = (TOP / "docs" / "plugins.md").read_text()
    (count,) = re.findall(rf"What the core itself offers \([^)]*?(\w+) {kind}s", text)
    registry = load_registry()
    owners = [registry.component(kind, name).distribution()[0] for name in registry.names(kind)]
    assert NUMBERS.index(count) + 1 == owners.count("arena-core")


@cache
def modules():
    """Return the paths of all modules of the tree."""
    tops = ("arena_core", "hydra_plugins", "plugins", "tests", "benchmarks", "scripts", "examples")
    return [f"/{path.relative_to(TOP)}" for top in tops for path in (TOP / top).rglob("*.py")]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(TOP)))
def test_every_quoted_module_is_there(path):
    quoted = set(re.findall(r"`([a-z*][\w/*-]*\.py)`", path.read_text())) - MODULES_OF_OTHERS
    assert [name for name in quoted if not fnmatch.filter(modules(), f"*/{name}")] == []
