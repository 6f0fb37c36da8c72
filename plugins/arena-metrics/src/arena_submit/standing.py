"""Standing benchmarks: fixed, versioned sets of problems and rules, and whether a pack keeps to one."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.resources import as_file, files
from typing import Any

from arena_core import InputFileError
from arena_core.commands import one_line
from arena_core.files import option_files, read_yaml
from arena_core.hosting import Registry, compose, to_plain
from arena_core.parameters import read_settings
from arena_submit.packing import Pack, PackedRun

FREE = (
    "planner",
    "predictor",
    "seed",
    "episodes",
    "executor",
    "resume",
    "report",
    "reference",
    "objective",
    "metrics",
    "recording",
    "experiment",
    "choices",
    "code",
)
OF_THE_SCENARIO = ("world.path", "task.path")
STRAIGHT = "constant_velocity"  # the predictor of packs that are older than predictors
NAMED = 3  # keys that differ of which an error tells
Condition = tuple[str, str]  # robot and scenario


@dataclass(frozen=True, slots=True)
class Part:
    """What a standing benchmark has of one experiment: episodes and seed of each run, robots, and the hash of each
    scenario's content, empty for those that are drawn by seed. A run without a scenario is called as its experiment.
    """

    experiment: str
    episodes: int
    seed: int
    robots: list[str]
    scenarios: dict[str, str]

    @property
    def conditions(self) -> list[Condition]:
        """Return all conditions of it that a planner has to face."""
        return [(robot, scenario) for robot in self.robots for scenario in self.scenarios]


@dataclass(frozen=True, slots=True)
class Season:
    """When a season opens, YYYY-MM-DD at 0:00 UTC, and which round of the beacon that is."""

    opens: str
    round: int


@dataclass(frozen=True, slots=True)
class Standing(Part):
    """A standing benchmark: the experiment of this name, and what belongs to it of others.

    ``tables`` are the titles of its tables by what scenarios begin with: planners are ranked in each for itself, and
    without them in one of all. In tables that begin as ``strict`` says, an episode with any contact is no success.
    ``searched`` are scenarios whose problems are named after the planner and the robot that they were searched against.
    ``beacon`` names where the seeds of ``seasons`` come from.
    """

    also: list[Part] = field(default_factory=list)
    tables: dict[str, str] = field(default_factory=dict)
    strict: list[str] = field(default_factory=list)
    searched: list[str] = field(default_factory=list)
    beacon: str = ""
    seasons: dict[str, Season] = field(default_factory=dict)

    @property
    def parts(self) -> list[Part]:
        """Return what it is made of, by experiment."""
        return [self, *self.also]

    @property
    def all_conditions(self) -> list[Condition]:
        """Return the conditions of all its parts."""
        return [condition for part in self.parts for condition in part.conditions]

    @property
    def problems(self) -> int:
        """Return how many episodes a planner drives."""
        return sum(len(part.conditions) * part.episodes for part in self.parts)


def read_standing(name: str) -> Standing:
    """Return a standing benchmark by its experiment's name."""
    with as_file(files("arena_submit") / "benchmarks" / f"{name}.yaml") as path:
        return read_settings(read_yaml(path, "a standing benchmark"), Standing, name)


def benchmark_of(pack: Pack) -> Standing | None:
    """Return the standing benchmark whose experiment is among those of a pack's runs, if it has no other; None where
    there is none.
    """
    names = {_experiment_of(run) for run in pack.runs}
    for path in (files("arena_submit") / "benchmarks").iterdir():
        if path.name.endswith(".yaml") and path.name.removesuffix(".yaml") in names:
            found = read_standing(path.name.removesuffix(".yaml"))
            return found if names <= {part.experiment for part in found.parts} else None
    return None


def check_standing(pack: Pack, wanted: Standing, registry: Registry) -> None:
    """Raise InputFileError where a pack is not the whole benchmark, of one planner and by its rules."""
    faced: dict[Condition, PackedRun] = {}
    for run in pack.runs:
        condition = run_condition(run)
        if fault := run_fault(run, wanted, registry) or ("is there twice" if condition in faced else ""):
            raise InputFileError(
                f"{pack.path}: {run.name} ({' '.join(condition)}) {fault}; allowed: "
                f"runs of experiment={wanted.experiment} as it is here"
            )
        faced[condition] = run
    lacking = [condition for condition in wanted.all_conditions if condition not in faced]
    if lacking:
        some = f"{len(lacking)} of {len(wanted.all_conditions)} conditions, {' '.join(lacking[0])} among them"
        experiments = " and ".join(f"experiment={part.experiment}" for part in wanted.parts)
        raise InputFileError(f"{pack.path}: lacks {some}; allowed: all of {experiments}")
    planners = sorted({planner_of(run) for run in pack.runs})
    if len(planners) > 1:
        raise InputFileError(f"{pack.path}: holds {', '.join(planners)}; allowed: one planner a pack")


def planner_of(run: PackedRun) -> str:
    """Return the planner's preset, with its predictor where people are not just expected to keep their velocity."""
    config = run.config
    choices, predictor = config.get("choices", {}), config.get("predictor", {}).get("name", STRAIGHT)
    name = str(choices.get("planner") or config["planner"]["name"])
    return one_line(name if predictor == STRAIGHT else f"{name}, predictor {choices.get('predictor', predictor)}", 60)


def run_condition(run: PackedRun) -> Condition:
    """Return the condition that a run says it is of."""
    return condition_of(run.config)


def condition_of(config: Mapping[str, Any]) -> Condition:
    """Return the condition that a configuration says it is of: one without a scenario is called as its experiment."""
    choices = config.get("choices", {})
    named = choices.get("scenario") or choices.get("experiment")
    return one_line(str(choices.get("robot")), 60), one_line(str(named), 60)


def _experiment_of(run: PackedRun) -> str:
    return str(run.config.get("choices", {}).get("experiment"))


def run_fault(run: PackedRun, wanted: Standing, registry: Registry) -> str:
    """Return in what a run is not of the benchmark; empty where it is."""
    robot, scenario = run_condition(run)
    part = next((one for one in wanted.parts if one.experiment == _experiment_of(run)), None)
    if part is None or robot not in part.robots or scenario not in part.scenarios:
        return "is no condition of it"
    if (run.seed, run.config.get("episodes")) != (part.seed, part.episodes):
        return f"has seed {run.seed} and {run.config.get('episodes')} episodes, not {part.seed} and {part.episodes}"
    if sorted(int(row["episode"]) for row in run.rows) != list(range(part.episodes)):
        return "has not every episode once"
    hashed = part.scenarios[scenario]
    if hashed and any((row.get("scenario_hash") or hashed) != hashed for row in run.rows):
        return "is of another version of the scenario"
    expected = _expected_values(part.experiment, robot, scenario, registry)
    own = dict(_flatten_json({key: value for key, value in run.config.items() if key not in FREE}))
    wrong = [_key_difference(key, own, expected) for key in {**expected, **own} if own.get(key) != expected.get(key)]
    more = [f"{len(wrong) - NAMED} more differ"] if len(wrong) > NAMED else []
    return ", ".join([*wrong[:NAMED], *more])


def _key_difference(key: str, own: Mapping[str, str], expected: Mapping[str, str]) -> str:
    """Return in what a key of a run is not as the benchmark has it in this version of the suite;
    packs of others may lack some.
    """
    name, value = one_line(key, 60), one_line(own.get(key, ""), 60)
    if key not in own:
        return f"lacks {name}, which is {expected[key]}"
    return (
        f"has {name} {value}, not {expected[key]}"
        if key in expected
        else f"has {name} {value}, which the experiment has not"
    )


def _expected_values(experiment: str, robot: str, scenario: str, registry: Registry) -> Mapping[str, str]:
    """Return all that the benchmark fixes in a condition, as JSON by dotted key."""
    if scenario == experiment:
        return _fixed_values(experiment, robot, None)
    with as_file(option_files("scenario", registry.manager)[scenario]) as path:
        option = read_yaml(path, "an option of the group scenario")
    paths = {key: json.dumps(found) for key in OF_THE_SCENARIO if (found := _value_at(option, key)) is not None}
    alike = json.dumps({key: value for key, value in _flatten_json(option) if key not in paths})
    return {**_fixed_values(experiment, robot, _first_alike.setdefault(alike, scenario)), **paths}


_first_alike: dict[str, str] = {}  # the first scenario of those whose options differ in their files alone


@lru_cache(maxsize=256)
def _fixed_values(experiment: str, robot: str, scenario: str | None) -> Mapping[str, str]:
    words = [f"experiment={experiment}", f"robot={robot}", *([f"scenario={scenario}"] if scenario else [])]
    config = to_plain(compose(words))
    return dict(_flatten_json({key: value for key, value in config.items() if key not in FREE}))


def _value_at(option: Mapping[str, Any], key: str) -> Any:
    group, _, name = key.partition(".")
    node = option.get(group)
    return node.get(name) if isinstance(node, Mapping) else None


def _flatten_json(node: Any, prefix: str = "") -> Iterator[tuple[str, str]]:
    """Yield every value of nested mappings as JSON, by its dotted key."""
    if isinstance(node, Mapping):
        for key, value in node.items():
            yield from _flatten_json(value, f"{prefix}{key}.")
    else:
        yield prefix.rstrip("."), json.dumps(node, sort_keys=True)
