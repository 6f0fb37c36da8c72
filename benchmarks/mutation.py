"""Faults that can be planted in a module, one at a time: each a small change of one expression."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass
from typing import Any

COMPARISONS: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.Gt),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Pow: ast.Mult,
}
EXTREMES = {"min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum", "argmin": "argmax"}
EXTREMES |= {"argmax": "argmin", "fmin": "fmax", "fmax": "fmin"}
SIGNED = ("float", "int", "Floats", "FloatArray", "NDArray[np.float64]")  # results whose sign is changed
TEXTS = (ast.JoinedStr, ast.List, ast.ListComp)  # "+" joins them


@dataclass(frozen=True, slots=True)
class Mutant:
    """A change of one expression: bytes ``start`` to ``end`` of the source become ``after``."""

    start: int
    end: int
    before: str
    after: str
    lines: range  # of the statement, as a tracer sees them

    def plant(self, source: bytes) -> bytes:
        """Return the source with the change in it."""
        return source[: self.start] + self.after.encode() + source[self.end :]


def find_mutants(source: bytes) -> list[Mutant]:
    """Return all changes that can be made in a module, in the order of the source."""
    offsets = [0]
    for line in source.splitlines(keepends=True):
        offsets.append(offsets[-1] + len(line))

    def place(line: int, column: int) -> int:
        return offsets[line - 1] + column

    found = []
    for statement, node, after in _changes(ast.parse(source)):
        start, end = place(node.lineno, node.col_offset), place(node.end_lineno, node.end_col_offset)
        lines = range(statement.lineno, node.end_lineno + 1)
        found.append(Mutant(start, end, source[start:end].decode(), after, lines))
    return sorted(found, key=lambda one: (one.start, one.end, one.after))


def _changes(node: ast.AST, statement: Any = None, returns: str = "") -> Iterator[tuple[Any, Any, str]]:
    """Yield statement, expression and what takes its place, for all that stands below a node."""
    if isinstance(node, ast.FunctionDef):
        returns = ast.unparse(node.returns) if node.returns else ""
    if isinstance(node, ast.stmt):
        statement = node
    for after in _replacements(node, returns):
        yield statement, node, after
    for child in _inner_nodes(node):
        yield from _changes(child, statement, returns)


def _inner_nodes(node: ast.AST) -> Iterator[ast.AST]:
    """Yield what stands below a node, without texts, types, decorators, errors and assertions."""
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST) and not isinstance(child, (ast.JoinedStr, ast.Raise, ast.Assert)):
                yield child


def _replacements(node: ast.AST, returns: str) -> Iterator[str]:
    match node:
        case ast.Compare():
            for k, operator in enumerate(node.ops):
                for other in COMPARISONS[type(operator)]:
                    yield _changed(node, ops=[*node.ops[:k], other(), *node.ops[k + 1 :]])
        case ast.BinOp() if type(node.op) in OPERATORS and not any(map(_is_text, (node.left, node.right))):
            yield _changed(node, op=OPERATORS[type(node.op)]())
        case ast.AugAssign() if type(node.op) in OPERATORS and not _is_text(node.value):
            yield _changed(node, op=OPERATORS[type(node.op)]())
        case ast.BoolOp():
            yield _changed(node, op=ast.Or() if isinstance(node.op, ast.And) else ast.And())
        case ast.UnaryOp(op=ast.Not() | ast.USub()) if not isinstance(node.operand, ast.Constant):
            yield f"({ast.unparse(node.operand)})"
        case ast.Constant(value=bool()):
            pass
        case ast.Constant(value=float()):
            yield repr(node.value * 1.1 if node.value else 1.0)
        case ast.Constant(value=int()):
            yield repr(node.value + 1)
        case ast.Name() | ast.Attribute() if (name := getattr(node, "attr", getattr(node, "id", ""))) in EXTREMES:
            yield _changed(node, **{"attr" if isinstance(node, ast.Attribute) else "id": EXTREMES[name]})
        case ast.Return(value=ast.expr()) if returns == "bool":
            yield f"return not ({ast.unparse(node.value)})"
        case ast.Return(value=ast.expr()) if returns in SIGNED and not isinstance(node.value, ast.Constant):
            yield f"return -({ast.unparse(node.value)})"


def _changed(node: Any, **fields: Any) -> str:
    other = copy(node)
    for name, value in fields.items():
        setattr(other, name, value)
    return ast.unparse(other)


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, TEXTS) or (isinstance(node, ast.Constant) and isinstance(node.value, (str, bytes)))
