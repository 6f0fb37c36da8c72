"""Where the models and links of a Gazebo world stood when it was saved: what is under ``state``, all poses
in the frame of the world.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

from arena_core import InputFileError
from arena_worlds.formats.xml_file import parse_numbers, quote_text

NOT_READ = ("insertions", "deletions")  # they would change what is there


@dataclass(frozen=True, slots=True)
class State:
    """Elements with the pose of a model, of its links and of the models in it, by their names; Gazebo Classic puts each
    there.

    ``element`` is None where the model stays where the file has it.
    """

    element: ElementTree.Element | None = None
    links: Mapping[str, ElementTree.Element] = field(default_factory=dict)
    models: Mapping[str, State] = field(default_factory=dict)


def state_of(path: Path, root: ElementTree.Element) -> State:
    """Return the first state of a file's world, for that is what Gazebo loads; raise InputFileError where
    it adds, removes or scales.
    """
    found = root.find("world/state")
    if found is None:
        return State()
    for tag in NOT_READ:
        for element in found.findall(tag):
            if len(element):
                raise InputFileError(f"{path}: state/{tag} is there; allowed: a state of models that the world has")
    return State(None, {}, _model_states(path, found))


def _model_states(path: Path, parent: ElementTree.Element) -> dict[str, State]:
    return {model.get("name", ""): _model_state(path, model) for model in parent.findall("model")}


def _model_state(path: Path, model: ElementTree.Element) -> State:
    """Return the state of a model; those without a pose stay."""
    scale = model.findtext("scale", "1 1 1")
    if parse_numbers(scale) != [1.0, 1.0, 1.0]:
        raise InputFileError(
            f"{path}: state of model {quote_text(model.get('name', ''))}: scale is {quote_text(scale)}; allowed: 1 1 1"
        )
    links = {link.get("name", ""): link for link in model.findall("link") if link.find("pose") is not None}
    return State(model if model.find("pose") is not None else None, links, _model_states(path, model))
