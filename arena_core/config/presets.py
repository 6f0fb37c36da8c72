"""The options of configuration groups as their YAML files say them: what each is, and its
parameters with value, unit and text.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources.abc import Traversable
from typing import TYPE_CHECKING, Any

from arena_core.base.errors import InputFileError
from arena_core.base.files import reason_of
from arena_core.config.option_file import ALLOWED, check_option, option_text
from arena_core.config.option_folders import option_files
from arena_core.config.registry import HOOKS, registry_of

if TYPE_CHECKING:
    import yaml
    from pluggy import PluginManager

Path = tuple[str, ...]  # of a key, from the outermost mapping inwards
COMMENT = re.compile(r"#\s*(\[(?P<unit>[^\]]*)\])?\s*(?P<text>.*)")
PACKAGE = re.compile(r"^#\s*@package\s+(\S+)", re.MULTILINE)
APART = ("defaults", "name")  # keys that are no parameters
TUNING = "_tuning"  # what the groups of options for one robot each end in
HERE = "@_here_"  # which has an option of a subgroup, base/dwa, put its keys where the file's own stand
SELF = "_self_"  # where a file's own values stand among those that it inherits


@dataclass(frozen=True, slots=True)
class Parameter:
    """One key of an option: where it stands, its value as it is written (empty above others),
    its unit and what it means.
    """

    path: Path
    value: str
    unit: str
    text: str


@dataclass(frozen=True, slots=True)
class Preset:
    """One option of a configuration group: its first line of comment, the component that it names, and its parameters
    in order.

    ``choices`` are the options of other groups that it is made of, ``package`` where Hydra puts its keys (empty: below
    its group's name).
    """

    about: str
    component: str
    parameters: Mapping[Path, Parameter]
    choices: Mapping[str, str]
    package: str


def options_of(group: str, manager: PluginManager) -> dict[str, Traversable]:
    """Return the file of every option of a group that can be chosen: without tunings for robots, and without those made
    of what is not installed.
    """
    files = option_files(group, manager)
    components = registry_of(manager).names(group) if group in HOOKS else None
    return {
        option: file
        for option, file in files.items()
        if TUNING not in f"{group}/{option}".rpartition("/")[0] and _is_whole(option, files, components)
    }


def _is_whole(option: str, files: Mapping[str, Traversable], components: Sequence[str] | None) -> bool:
    """Return whether the options of its group that an option derives from are there, and its component, where it names
    one; a file that cannot be read is left to whoever reads it.
    """
    try:
        node = _compose_yaml(option_text(files[option]), files[option])
    except InputFileError:
        return True
    component = next((value.value for key, value in node.value if key.value == "name"), "") if node else ""
    if component and components is not None and component not in components:
        return False
    bases = [base for base in _base_options(node) if base not in (SELF, option) and re.fullmatch(r"[\w/-]+", base)]
    return all(base in files and _is_whole(base, files, components) for base in bases)


def read_preset(option: str, files: Mapping[str, Traversable], inside: tuple[str, ...] = ()) -> Preset:
    """Read an option out of the ``files`` of its group, with what it inherits from other options of the group.

    Its tuning for a robot and components inside it are not part of it. Raises InputFileError for a file that is no
    YAML.
    """
    text = option_text(files[option])
    node = _compose_yaml(text, files[option])
    own = {parameter.path: parameter for parameter in _list_parameters(node, text.splitlines(), text)}
    component = next((value.value for key, value in node.value if key.value == "name"), "") if node else ""
    parameters: dict[Path, Parameter] = {}
    choices = _group_choices(node)
    for base in _base_options(node):
        if base == SELF:
            _merge_parameters(parameters, own)
        elif base in files and base not in inside:
            inherited = read_preset(base, files, (*inside, option))
            _merge_parameters(parameters, inherited.parameters)
            component = component or inherited.component
            choices = {**inherited.choices, **choices}
    package = PACKAGE.search(text)
    return Preset(_first_comment(text), component, parameters, choices, package[1] if package else "")


def about_of(file: Traversable) -> str:
    """Return what an option is, by its first line of comment; the rest of its file may be anything."""
    return _first_comment(option_text(file))


def _first_comment(text: str) -> str:
    """Return the first line of comment ahead of the first key, without Hydra's directives."""
    for line in text.splitlines():
        if line and not line.startswith("#"):
            return ""
        if line.startswith("#") and not line.startswith("# @"):
            return line.lstrip("# ")
    return ""


@lru_cache(maxsize=1024)
def _parse_yaml(text: str) -> Any:
    import yaml

    return yaml.compose(text, getattr(yaml, "CSafeLoader", yaml.SafeLoader))


def _compose_yaml(text: str, file: Traversable) -> yaml.MappingNode | None:
    import yaml

    try:
        node = _parse_yaml(text)
    except (yaml.YAMLError, RecursionError) as error:
        raise InputFileError(f"{file}: is no YAML ({reason_of(error)}); allowed: {ALLOWED}") from None
    check_option(file, node)
    return node  # type: ignore[no-any-return]


def _base_options(node: yaml.MappingNode | None) -> list[str]:
    """Return the options of its own group that a file inherits from, with ``_self_`` in its
    place, at the end unless it is there.
    """
    named = [entry.value.removesuffix(HERE) for entry in _defaults_list(node) if isinstance(entry.value, str)]
    return named if SELF in named else [*named, SELF]


def _group_choices(node: yaml.MappingNode | None) -> dict[str, str]:
    """Return the options of other groups that a file is made of, by group; of several those between commas."""
    entries = [pair for entry in _defaults_list(node) if not isinstance(entry.value, str) for pair in entry.value]
    chosen = {
        key.value: value.value if isinstance(value.value, str) else [v.value for v in value.value]
        for key, value in entries
    }
    return {
        group: ",".join(option) if isinstance(option, list) else option
        for group, option in chosen.items()
        if group.isidentifier()
    }


def _defaults_list(node: yaml.MappingNode | None) -> Sequence[yaml.Node]:
    return next((value.value for key, value in node.value if key.value == "defaults"), ()) if node else ()


def _merge_parameters(parameters: dict[Path, Parameter], others: Mapping[Path, Parameter]) -> None:
    """Take in the parameters of another file: its values count, texts stay where it has none of its own."""
    for path, other in others.items():
        before = parameters.get(path)
        described = (
            other
            if other.unit or other.text or before is None
            else Parameter(path, other.value, before.unit, before.text)
        )
        parameters[path] = described


def _list_parameters(node: Any, lines: list[str], text: str, path: Path = ()) -> Iterator[Parameter]:
    """Yield every key of a mapping, each ahead of those below it; those inside braces have no comments of their own."""
    import yaml

    for key, value in node.value if node is not None else ():
        if path or key.value not in APART:
            nested = isinstance(value, yaml.MappingNode) and bool(value.value)
            written = "" if nested else _one_line(value, text)
            listed = isinstance(value, yaml.SequenceNode) and not value.flow_style
            end = key.end_mark if nested or listed else value.end_mark
            comment = COMMENT.search(lines[end.line][end.column :]) if end.line < len(lines) else None
            described = (comment["unit"] or "", comment["text"]) if comment else ("", "")
            yield Parameter((*path, key.value), written, *described)
            if nested:
                yield from _list_parameters(value, [] if value.flow_style else lines, text, (*path, key.value))


def _one_line(node: yaml.Node, text: str) -> str:
    """Return a value as it would be written on one line, without the comments that stand inside it."""
    import yaml

    if isinstance(node, yaml.SequenceNode):
        return f"[{', '.join(_one_line(value, text) for value in node.value)}]"
    if isinstance(node, yaml.MappingNode):
        return f"{{{', '.join(f'{key.value}: {_one_line(value, text)}' for key, value in node.value)}}}"
    return " ".join(text[node.start_mark.index : node.end_mark.index].split())
