"""What a set of values is worth on one problem: an expression of the metrics of its episode."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from arena_core import ConfigurationError

# a success is worth more than any number of collisions, these more than any time, and this more than what people lose:
# nearly in this order
DEFAULT = (
    "strict_success - 0.05 * min(collisions, 5) - 0.2 * known(time_to_goal, time_limit) / time_limit "
    "- 0.1 * min(max(known(cost.people_delay, 0), 0), time_limit) / time_limit"
)
COST = "cost."  # of columns that `arena cost` finds out, which take the twins of an episode
MOST = 4  # objectives that can be sought together
TIME_LIMIT = "time_limit"  # the task's, beside the metrics, s
ALLOWED = "metrics, numbers, + - * /, min(a, b), max(a, b) and known(a, b), which is b where a is not defined"
LONGEST = 1000  # characters
FUNCTIONS: Mapping[str, Callable[[float, float], float]] = {
    "min": min,
    "max": max,
    "known": lambda value, otherwise: value if math.isfinite(value) else otherwise,
}


class Objective:
    """An expression that is better where it is higher; ``text`` is as the user wrote it."""

    def __init__(self, text: str, metrics: Sequence[str]) -> None:
        self.text = text
        self._root = _parse(text)
        known = [*metrics, TIME_LIMIT]
        for name in self.names:
            if name not in known:
                raise ConfigurationError(f"objective asks for {name}; allowed: {', '.join(known)}")

    @property
    def names(self) -> list[str]:
        """Return the metrics that it asks for."""
        return sorted(set(_names_in(self._root)))

    def value(self, row: Mapping[str, Any], time_limit: float) -> float:
        """Return what an episode is worth; NaN where a metric is not defined and no ``known`` says otherwise."""
        figures = {
            name: float(row[name]) if row.get(name) not in ("", None) else math.nan
            for name in self.names
            if name != TIME_LIMIT
        }
        return _value_of(self._root, {**figures, TIME_LIMIT: time_limit})


class Objectives:
    """What is sought: an expression, or several between brackets; ``text`` is as the user wrote it."""

    def __init__(self, text: str, metrics: Sequence[str]) -> None:
        self.text = text
        self.parts = [Objective(one, metrics) for one in split_objectives(text)]

    @property
    def costs(self) -> bool:
        """Return whether it asks for what the robot cost the people."""
        return any(name.startswith(COST) for part in self.parts for name in part.names)

    def value(self, row: Mapping[str, Any], time_limit: float) -> tuple[float, ...]:
        """Return what an episode is worth by each; NaN as in ``Objective``."""
        return tuple(part.value(row, time_limit) for part in self.parts)


def split_objectives(text: str) -> list[str]:
    """Return the expressions between brackets, else the text; raise ConfigurationError for other than two to four."""
    if not text.strip().startswith("["):
        return [text]
    try:
        root = ast.parse(text[:LONGEST].strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        root = None
    parts = [ast.unparse(one) for one in root.elts] if isinstance(root, ast.List) else []
    if not 2 <= len(set(parts)) == len(parts) <= MOST:
        raise ConfigurationError(
            f"objective is {text[:LONGEST]!r}; allowed: [A, B], two to {MOST} different expressions, or one alone"
        )
    return parts


def _parse(text: str) -> ast.expr:
    try:
        if len(text) > LONGEST:
            raise ValueError(f"{len(text)} characters")
        root = ast.parse(text, mode="eval").body
        _check(root)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ConfigurationError(f"objective is {text[:LONGEST]!r} ({error}); allowed: {ALLOWED}") from None
    return root


def _check(node: ast.expr) -> None:
    """Raise ValueError for what is no part of an expression of metrics."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Sub, ast.Mult, ast.Div)):
        _check(node.left)
        _check(node.right)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        _check(node.operand)
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS:
        if len(node.args) != 2 or node.keywords:
            raise ValueError(f"{node.func.id} takes two values")
        for argument in node.args:
            _check(argument)
    elif isinstance(node, ast.Attribute):
        _check(node.value)
    elif isinstance(node, ast.Constant) and type(node.value) not in (int, float):
        raise ValueError(f"{node.value!r} is no number")
    elif not isinstance(node, (ast.Name, ast.Constant)):
        raise ValueError(f"{type(node).__name__} is not known")


def _names_in(node: ast.expr) -> Iterator[str]:
    if isinstance(node, ast.BinOp):
        yield from (*_names_in(node.left), *_names_in(node.right))
    elif isinstance(node, ast.UnaryOp):
        yield from _names_in(node.operand)
    elif isinstance(node, ast.Call):
        yield from (name for argument in node.args for name in _names_in(argument))
    elif isinstance(node, (ast.Name, ast.Attribute)):
        yield ast.unparse(node)  # a pack's metric is PACK.METRIC


def _value_of(node: ast.expr, figures: Mapping[str, float]) -> float:
    if isinstance(node, ast.BinOp):
        return _combine(node.op, _value_of(node.left, figures), _value_of(node.right, figures))
    if isinstance(node, ast.UnaryOp):
        return -_value_of(node.operand, figures)
    if isinstance(node, ast.Call):
        first, second = (_value_of(argument, figures) for argument in node.args)
        return FUNCTIONS[ast.unparse(node.func)](first, second)
    if isinstance(node, ast.Constant):
        return float(node.value)  # type: ignore[arg-type]
    return figures[ast.unparse(node)]


def _combine(operator: ast.operator, left: float, right: float) -> float:
    if isinstance(operator, ast.Add):
        return left + right
    if isinstance(operator, ast.Sub):
        return left - right
    if isinstance(operator, ast.Mult):
        return left * right
    return left / right if right else math.nan
