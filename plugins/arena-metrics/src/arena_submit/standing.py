"""Standing benchmarks: fixed, versioned sets of problems and rules, and whether a pack keeps to one."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
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
class Standing:
    """A standing benchmark: the experiment of this name, its episodes and seed, robots, and the
    hash of each scenario's content.
    """

    experiment: str
    episodes: int
    seed: int
    robots: list[str]
    scenarios: dict[str, str]

    @property
    def conditions(self) -> list[Condition]:
        """Return all conditions that a planner has to face."""
        return [(robot, scenario) for robot in self.robots for scenario in self.scenarios]


def read_standing(name: str) -> Standing:
    """Return a standing benchmark by its experiment's name."""
    with as_file(files("arena_submit") / "benchmarks" / f"{name}.yaml") as path:
        return read_settings(read_yaml(path, "a standing benchmark"), Standing, name)


def benchmark_of(pack: Pack) -> Standing | None:
    """Return the standing benchmark that a pack's runs say they are of, None where they are of none."""
    names = {str(run.config.get("choices", {}).get("experiment")) for run in pack.runs}
    known = {
        path.name.removesuffix(".yaml")
        for path in (files("arena_submit") / "benchmarks").iterdir()
        if path.name.endswith(".yaml")
    }
    return read_standing(names.pop()) if len(names) == 1 and names <= known else None


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
    lacking = [condition for condition in wanted.conditions if condition not in faced]
    if lacking:
        some = f"{len(lacking)} of {len(wanted.conditions)} conditions, {' '.join(lacking[0])} among them"
        raise InputFileError(f"{pack.path}: lacks {some}; allowed: all of experiment={wanted.experiment}")
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
    choices = run.config.get("choices", {})
    return one_line(str(choices.get("robot")), 60), one_line(str(choices.get("scenario")), 60)


def run_fault(run: PackedRun, wanted: Standing, registry: Registry) -> str:
    """Return in what a run is not of the benchmark; empty where it is."""
    robot, scenario = run_condition(run)
    if robot not in wanted.robots or scenario not in wanted.scenarios:
        return "is no condition of it"
    if (run.seed, run.config.get("episodes")) != (wanted.seed, wanted.episodes):
        return f"has seed {run.seed} and {run.config.get('episodes')} episodes, not {wanted.seed} and {wanted.episodes}"
    if sorted(int(row["episode"]) for row in run.rows) != list(range(wanted.episodes)):
        return "has not every episode once"
    if any(row.get("scenario_hash") != wanted.scenarios[scenario] for row in run.rows if row.get("scenario_hash")):
        return "is of another version of the scenario"
    expected = {**_fixed_values(wanted.experiment, robot), **_scenario_paths(scenario, registry)}
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


@lru_cache(maxsize=16)
def _fixed_values(experiment: str, robot: str) -> Mapping[str, str]:
    """Return all that the benchmark fixes but the paths of its scenarios, as JSON by dotted key."""
    first = next(iter(read_standing(experiment).scenarios))
    config = to_plain(compose([f"experiment={experiment}", f"robot={robot}", f"scenario={first}"]))
    return {
        key: value
        for key, value in _flatten_json({k: v for k, v in config.items() if k not in FREE})
        if key not in OF_THE_SCENARIO
    }


def _scenario_paths(scenario: str, registry: Registry) -> Mapping[str, str]:
    """Return what a scenario's option says of map and file."""
    with as_file(option_files("scenario", registry.manager)[scenario]) as path:
        option = read_yaml(path, "an option of the group scenario")
    return {key: json.dumps(option[key.partition(".")[0]]["path"]) for key in OF_THE_SCENARIO}


def _flatten_json(node: Any, prefix: str = "") -> Iterator[tuple[str, str]]:
    """Yield every value of nested mappings as JSON, by its dotted key."""
    if isinstance(node, Mapping):
        for key, value in node.items():
            yield from _flatten_json(value, f"{prefix}{key}.")
    else:
        yield prefix.rstrip("."), json.dumps(node, sort_keys=True)
