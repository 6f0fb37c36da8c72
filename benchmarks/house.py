"""Measure the tree itself: names, arguments, interfaces, lines, tokens, start-up.

usage: .venv/bin/python benchmarks/house.py [DIR] [--against DIR] [--times N]

DIR is a checkout, by default this one; ``--against`` shows another beside it, and ``--times N`` takes the medians of N
starts in turn, of processor time, each with the interpreter of the checkout's own .venv. Names, arguments and tokens
are those of the packages (arena_core, hydra_plugins, plugins/*/src); lines and private interfaces those of all Python,
tests and scripts included, and of the pages' JavaScript.
"""

from __future__ import annotations

import argparse
import ast
import io
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import tokenize
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]
OURS = ("arena", "hydra_plugins", "scout_lab")  # how import names of this project begin
LEFT_OUT = {".venv", "node_modules", "build", "dist", "site", ".git"}
LONGEST, MOST = 120, 5  # columns of a line, arguments of a function
KERNELS = {"compiled", "borrowing", "inner", "inlined"}
# which Python's own documentation offers
DOCUMENTED = {"_replace", "_asdict", "_fields", "_make", "_exit", "_getframe"}
INTERNAL = re.compile(r"(?!arena)\w+(\.\w+)*\._internal[\w.]*")  # a module's name in a text
DEFINED = re.compile(r"(?:\b(?:def |class |self\.|cls\.)|^\s*|[,(]\s*)(_[a-zA-Z]\w*)\b", re.MULTILINE)
MEMBER = re.compile(r"\.(_[a-zA-Z]\w*)")
IMPORTED = re.compile(r"\._\w|\bimport .*\b_\w")
CHANGED = re.compile(
    r"^\s*(?!self\.|cls\.|#)[\w.\[\]()\"']+\.\w+ (?:, .*)?= |\bsetattr\(|\bvars\(.*\] =|^\s*del .*\.", re.MULTILINE
)
REASON = re.compile(r"#.*noqa: .*SLF001.* - \w")
SILENT = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENCODING,
    tokenize.ENDMARKER,
}
TRIVIAL = (
    *(
        "run",
        "planner=pure_pursuit",
        "robot=jackal",
        "world=empty",
        "world.width=8",
        "world.height=8",
        "task.pedestrians=0",
    ),
    *("localizer=ground_truth", "executor=serial", "report=false", "episodes=1", "hydra.run.dir=run"),
)
STARTS = {"arena list": ("list",), "a trivial run": TRIVIAL}
Function = ast.FunctionDef | ast.AsyncFunctionDef


def main(words: Sequence[str]) -> int:
    """Print the table of one checkout, or of two."""
    parser = argparse.ArgumentParser("house", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkout", type=Path, nargs="?", default=HERE, metavar="DIR")
    parser.add_argument("--against", type=Path, metavar="DIR")
    parser.add_argument(
        "--times", type=int, default=0, metavar="N", help="how often to start each command (0: not at all)"
    )
    given = parser.parse_args(words)
    tops = [given.checkout.resolve(), *([given.against.resolve()] if given.against else [])]
    for top in tops:
        if not (top / "arena_core").is_dir():
            parser.error(f"{top} is no checkout; allowed: a folder with arena_core")
    rows = [(what, *(measure(top) for top in tops)) for what, measure in MEASURES.items()]
    print(format_table([("what", *(top.name for top in tops)), *rows, *command_times(tops, given.times)]))
    return 0


def source_files(top: Path, *endings: str) -> Iterator[Path]:
    """Yield the files of a checkout, in order, without what was installed or built there."""
    for folder, inside, names in os.walk(top):
        inside[:] = sorted(name for name in inside if name not in LEFT_OUT)
        yield from (Path(folder, name) for name in sorted(names) if name.endswith(endings))


def package_modules(top: Path) -> Iterator[Path]:
    """Yield the modules of the packages."""
    for folder in (top / "arena_core", top / "hydra_plugins", *sorted(top.glob("plugins/*/src"))):
        yield from source_files(folder, ".py")


def package_functions(top: Path) -> Iterator[Function]:
    """Yield all functions of the packages."""
    for path in package_modules(top):
        yield from (node for node in ast.walk(ast.parse(path.read_bytes())) if isinstance(node, Function))


def one_word_names(top: Path) -> str:
    """Return the share of functions whose name is a single word; Python's own, ``__init__``, do not count."""
    names = [function.name.strip("_") for function in package_functions(top) if not function.name.startswith("__")]
    return f"{100 * sum('_' not in name for name in names) / len(names):.1f} %"


def argument_count(function: Function) -> int:
    """Return how many arguments a function takes, keyword-only ones too, without ``self``."""
    return len(_by_position(function)) + len(function.args.kwonlyargs)


def _by_position(function: Function) -> list[ast.arg]:
    return [one for one in (*function.args.posonlyargs, *function.args.args) if one.arg not in ("self", "cls")]


def many_arguments(top: Path) -> int:
    """Return how many functions and constructors take more than ``MOST`` arguments."""
    return sum(argument_count(function) > MOST for function in package_functions(top))


def many_arguments_of_python(top: Path) -> int:
    """Return the same without kernels, which take tables as arguments."""
    return sum(argument_count(function) > MOST and not _is_kernel(function) for function in package_functions(top))


def _is_kernel(function: Function) -> bool:
    return any(isinstance(decorator, ast.Name) and decorator.id in KERNELS for decorator in function.decorator_list)


def positional_booleans(top: Path) -> int:
    """Return how many functions take a boolean by position."""
    return sum(
        any(one.annotation and ast.unparse(one.annotation) == "bool" for one in _by_position(f))
        for f in package_functions(top)
    )


def public_names(top: Path) -> int:
    """Return how many names arena_core offers."""
    body = ast.parse((top / "arena_core" / "__init__.py").read_bytes()).body
    lists = [node.value for node in body if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"]
    return sum(len(names.elts) for names in lists if isinstance(names, ast.List | ast.Tuple))


def foreign_privates(top: Path) -> list[str]:
    """Return where Python of a checkout uses private names of other distributions without a reason beside it, as PLACE:
    NAME.

    Private are modules and names with a leading underscore, ``_internal`` among them; a member counts as another's
    where nothing in the checkout defines one of its name.
    """
    texts = {path: path.read_text(encoding="utf-8") for path in source_files(top, ".py")}
    own = {name for text in texts.values() for name in DEFINED.findall(text)} | DOCUMENTED
    found = []
    for path, text in texts.items():
        if not (set(MEMBER.findall(text)) - own or IMPORTED.search(text)):
            continue
        lines = text.splitlines()
        for node in ast.walk(ast.parse(text)):
            found += [
                f"{path.relative_to(top)}:{node.lineno}: {name}"  # type: ignore[attr-defined]
                for name in (*_imported_names(node), *_reached_names(node, own))
                if not REASON.search(lines[node.lineno - 1])  # type: ignore[attr-defined]
            ]
    return found


def foreign_patches(top: Path) -> list[str]:
    """Return where Python of a checkout replaces what an import from another distribution offers, as PLACE: NAME."""
    found = []
    for path in source_files(top, ".py"):
        if not CHANGED.search(text := path.read_text(encoding="utf-8")):
            continue
        nodes = list(ast.walk(ast.parse(text)))
        foreign = {name for node in nodes for name in _foreign_names(node)}
        changed = [(node, place) for node in nodes for place in _set_targets(node) if _root_name(place) in foreign]
        for node, place in changed:
            line = node.lineno  # type: ignore[attr-defined]
            found.append(f"{path.relative_to(top)}:{line}: {ast.unparse(place)}")
    return found


def _foreign_names(node: ast.AST) -> Iterator[str]:
    """Yield the names that an import from other distributions gives a module."""
    if isinstance(node, ast.Import | ast.ImportFrom) and not getattr(node, "level", 0):
        for alias in node.names:
            root = (getattr(node, "module", None) or alias.name).partition(".")[0]
            if not root.startswith(OURS) and root not in sys.stdlib_module_names:
                yield alias.asname or alias.name.partition(".")[0]


def _root_name(place: ast.AST) -> str:
    """Return the name that a place begins with."""
    while isinstance(place, ast.Attribute | ast.Subscript | ast.Call):
        place = place.func if isinstance(place, ast.Call) else place.value
    return place.id if isinstance(place, ast.Name) else ""


def _set_targets(node: ast.AST) -> Iterator[ast.expr]:
    """Yield what has an attribute set: ``x.y = 1``, ``setattr(x, "y", 1)``, ``vars(x)["y"] = 1``."""
    if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store | ast.Del):
        yield node
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "setattr":
        yield node.args[0]
    elif isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store) and _root_name(node.value) == "vars":
        yield from node.value.args[:1]  # type: ignore[attr-defined]


def _imported_names(node: ast.AST) -> Iterator[str]:
    names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
    if isinstance(node, ast.ImportFrom) and not node.level and node.module != "__future__":
        names = [f"{node.module}.{alias.name}" for alias in node.names]
    for name in names:
        parts = name.split(".")
        if any(_is_private(part) for part in parts[1:]) and not parts[0].startswith(OURS):
            yield name


def _reached_names(node: ast.AST, own: set[str]) -> Iterator[str]:
    if isinstance(node, ast.Attribute) and _is_private(node.attr) and node.attr not in own:
        if not _is_own(node.value):
            yield ast.unparse(node)
    elif (
        isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and re.fullmatch(r"(?!arena)\w+(\.\w+)*\._internal[\w.]*", node.value)
    ):
        yield node.value


def _is_own(value: ast.expr) -> bool:
    """Return whether this is ``self``, ``cls`` or ``super()``: what a class has inherited is its own."""
    name = value.func if isinstance(value, ast.Call) else value
    return isinstance(name, ast.Name) and name.id in ("self", "cls", "super")


def _is_private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__")


def long_lines(top: Path) -> int:
    """Return how many lines of Python and JavaScript are longer than ``LONGEST`` columns."""
    texts = (path.read_text(encoding="utf-8") for path in source_files(top, ".py", ".js"))
    return sum(len(line) > LONGEST for text in texts for line in text.splitlines())


def code_tokens(top: Path) -> int:
    """Return how many tokens the packages have, without comments, docstrings and layout."""
    return sum(_count_tokens(path.read_text(encoding="utf-8")) for path in package_modules(top))


def _count_tokens(text: str) -> int:
    """Return the tokens of a module; a text that is a statement of its own is a docstring."""
    count, begins = 0, True
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type in SILENT:
            begins = begins or token.type in (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)
            continue
        count += not (begins and token.type == tokenize.STRING)
        begins = False
    return count


def distribution_count(top: Path) -> int:
    """Return how many packages can be installed by name."""
    return len(list(top.glob("plugins/*/pyproject.toml"))) + 1


MEASURES: dict[str, Callable[[Path], object]] = {
    "function names of one word": one_word_names,
    f"functions with more than {MOST} arguments": many_arguments,
    "the same without kernels": many_arguments_of_python,
    "functions with positional booleans": positional_booleans,
    "public names of arena_core": public_names,
    "private interfaces of others": lambda top: len(foreign_privates(top)),
    f"lines over {LONGEST} columns": long_lines,
    "code tokens": code_tokens,
    "distributions": distribution_count,
}


def command_times(tops: Sequence[Path], repeats: int) -> Iterator[tuple[object, ...]]:
    """Yield the median processor time of each command in each checkout, in turn, and the ratio
    of the first to the second.
    """
    for what, words in STARTS.items() if repeats else ():
        taken = [[run_command(top, words) for top in tops] for _ in range(repeats + 1)][1:]  # the first compiles
        medians = [statistics.median(seconds) for seconds in zip(*taken, strict=True)]
        yield f"{what}, s of processor time", *(f"{seconds:.2f}" for seconds in medians)
        if len(tops) == 2:
            yield f"{what}, ratio", f"{medians[0] / medians[1]:.2f}", ""


def run_command(top: Path, words: Sequence[str]) -> float:
    """Run the command line of a checkout in an empty folder; return its processor time, s."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [str(top / ".venv/bin/python"), "-m", "arena_core.cli.main", *words]
        subprocess.run(command, cwd=folder, env=environment, capture_output=True, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def format_table(rows: Sequence[Sequence[object]]) -> str:
    """Return rows as aligned text."""
    cells = [[str(cell) for cell in row] for row in rows]
    widths = [max(len(row[column]) for row in cells) for column in range(len(cells[0]))]
    return "\n".join(
        "  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in cells
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
