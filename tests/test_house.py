"""What benchmarks/house.py measures, and what holds for this tree."""

import importlib.util
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[1]
SETTINGS = ("GlobalHydra.instance().hydra", "HydraConfig.instance().cfg")  # public, and set as Hydra itself sets them
HIDDEN = "_internal"
SPOILS = "tests/planners/misbehaving.py"  # a planner that spoils numpy, for tests of what a run withstands


@pytest.fixture(scope="module")
def house():
    spec = importlib.util.spec_from_file_location("house", TOP / "benchmarks" / "house.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


SMALL = '''"""A module."""

import hydra
from hydra._internal.utils import run
from hydra.core.utils import _flush_loggers
from numba.core.registry import CPUDispatcher
from arena_core.config import plugins as _plugins

NAMES = {"main": "hydra._internal.main", "help": "see _internal"}


class Robot(Base):
    """Drives."""

    def __init__(self, a, b, c, d, e, f: bool = False):
        self._own, self._theirs = a, super()._base
        b._own, b._foreign = 1, 2

    def step_on(self, *, a: bool, b, c, d, e):  # a comment
        return self._inherited._deep or a._replace(x=1)


@borrowing
def kernel(a, b, c, d, e, f: bool, g):
    a._asked()  # noqa: SLF001 - there is no other way
    hydra.main = vars(CPUDispatcher)["x"] = None
    setattr(CPUDispatcher, "y", 1)
    _plugins.z = 1
'''


@pytest.fixture
def small(tmp_path):
    """A checkout of one module."""
    (tmp_path / "arena_core").mkdir()
    (tmp_path / "arena_core" / "__init__.py").write_text('__all__ = [\n    "One",\n    "two",\n]\n')
    (tmp_path / "arena_core" / "robot.py").write_text(SMALL)
    (tmp_path / "arena_core" / "page.js").write_text("x" * 121 + "\n" + "x" * 120)
    (tmp_path / "pyproject.toml").write_text("")
    (tmp_path / ".venv").mkdir()
    (tmp_path / ".venv" / "other.py").write_text("x" * 130)
    return tmp_path


def test_names_arguments_and_booleans_are_counted(house, small):
    assert house.one_word_names(small) == "50.0 %"
    assert (house.many_arguments(small), house.many_arguments_of_python(small), house.positional_booleans(small)) == (
        2,
        1,
        2,
    )


def test_lines_names_and_distributions_are_counted(house, small):
    assert (house.long_lines(small), house.public_names(small), house.distribution_count(small)) == (1, 2, 1)


def test_docstrings_comments_and_layout_are_no_code(house):
    text = '"""One."""\n\n\ndef f(x):\n    """Two.\n\n    More.\n    """\n    return "x" + x  # three\n'
    assert house._count_tokens(text) == house._count_tokens('def f(x):\n    return "x" + x\n') == 10


def test_private_parts_of_others_are_found_where_no_reason_stands_beside_them(house, small):
    found = {place.partition(": ")[2] for place in house.foreign_privates(small)}
    assert found == {
        f"hydra.{HIDDEN}.utils.run",
        "hydra.core.utils._flush_loggers",
        f"hydra.{HIDDEN}.main",
        "b._foreign",
        "self._inherited._deep",
    }


def test_what_replaces_parts_of_others_is_found(house, small):
    assert {place.partition(": ")[2] for place in house.foreign_patches(small)} == {"hydra.main", "CPUDispatcher"}


def test_two_checkouts_stand_side_by_side(house, small, capsys):
    assert house.main([str(small), "--against", str(small)]) == 0
    assert "private interfaces of others 5 5" in [
        " ".join(line.split()) for line in capsys.readouterr().out.splitlines()
    ]
    with pytest.raises(SystemExit):
        house.main([str(small / "arena_core")])


def test_this_tree_uses_no_private_part_of_another_distribution_without_a_reason(house):
    assert house.foreign_privates(TOP) == []


def test_this_tree_replaces_no_part_of_another_distribution(house):
    assert [
        place for place in house.foreign_patches(TOP) if not place.endswith(SETTINGS) and not place.startswith(SPOILS)
    ] == []


def test_no_line_of_this_tree_is_too_long(house):
    assert house.long_lines(TOP) == 0


def test_few_functions_of_this_tree_take_a_boolean_by_position_or_more_than_five_arguments(house):
    assert house.positional_booleans(TOP) <= 20
    assert house.many_arguments_of_python(TOP) <= 67
    assert house.many_arguments(TOP) <= 215
