"""``arena tune``: from a planner and a robot to a preset with its card."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from hashlib import blake2b
from json import dumps
from pathlib import Path
from typing import Any, ClassVar

from arena_core import ConfigurationError
from arena_core.commands import Command, complete_overrides, interrupts, key_value, read_words
from arena_core.files import options_of
from arena_core.hosting import (
    Registry,
    check_search_space,
    digest_code,
    load_registry,
    lock_folder,
    require_extra,
    search_space_of,
    to_plain,
    value_at,
    values_of,
)
from arena_core.parameters import NonNegativeInt, PositiveInt
from arena_core.records import TEXT, build_metrics, metric_column
from arena_tuning.budget import read_budget
from arena_tuning.driving import Cells, Driver, compose_cells
from arena_tuning.folder import open_folder
from arena_tuning.journal import Journal, Values
from arena_tuning.objective import DEFAULT, Objective
from arena_tuning.preset import check_free, preset_path
from arena_tuning.problems import read_problem_sets
from arena_tuning.results import write_results
from arena_tuning.sampling import SAMPLERS, plain_values
from arena_tuning.study import Plan

USAGE = (
    "arena tune planner=NAME robot=NAME [budget=2000 or budget=20min] [seed=0] [objective=EXPRESSION] [problems=v1] "
    "[sampler=tpe] [finalists=4] [preset=NAME] [conf=DIR] [out=DIR] [resume=true] [KEY=VALUE ...]"
)
OWN = ("planner", "robot", "budget", "seed", "objective", "problems", "sampler", "finalists", "preset", "conf", "out")
KEYS = (*OWN, "resume")
NEEDED = ("optuna", "cmaes", "sklearn")
BUDGET = "2000"  # [episodes] of a search
FINALISTS = 4  # sets of values that are compared on the problems of validation


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """What is tuned, on what, and where its results go."""

    facts: Mapping[str, Any]
    plan: Plan
    cells: Cells
    present: Values
    objective: Objective
    executor: Mapping[str, Any]
    finalists: int
    folder: Path
    preset: Path

    @property
    def digest(self) -> str:
        """Return what the request is recognised by."""
        return blake2b(dumps(self.settings, sort_keys=True).encode(), digest_size=8).hexdigest()

    @property
    def settings(self) -> dict[str, Any]:
        """Return what must stay the same where a tuning goes on; its budget may grow."""
        chosen = {"seed": self.plan.seed, "sampler": self.plan.sampler, "finalists": self.finalists}
        return {**self.facts, **chosen, "present": dict(self.present)}


class TuneCommand(Command):
    """Tune a planner for a robot."""

    help: ClassVar[str] = "values of a planner that suit a robot: arena tune planner=teb robot=jackal"
    kept: ClassVar[str] = "finished episodes are kept, resume=true (with the same words) goes on from there"

    def run(self, arguments: Sequence[str]) -> int:
        """Search, choose, judge, and write what came of it; a preset only where it is better."""
        if any(word in ("-h", "--help") for word in arguments):
            print(f"usage: {USAGE}")
            return 0
        require_extra("arena tune", NEEDED, "arena-metrics[tune]")
        words = read_words(USAGE, arguments, keys=KEYS, overrides=None)
        resume = words.value("resume", bool, False)
        registry = load_registry()
        request = read_request(arguments, registry)
        with interrupts.heard(), interrupts.held(), lock_folder(request.folder):
            open_folder(request.folder, request.settings, resume=resume)
            tune(request, registry)
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the planners that have a search space, own keys and overrides."""
        if word.startswith("planner="):
            return [f"planner={name}" for name in options_of("tune", load_registry().manager)]
        if word.startswith("sampler="):
            return [f"sampler={name}" for name in SAMPLERS]
        return [*(f"{key}=" for key in OWN), "resume=true", *complete_overrides(words, word)]


def read_request(arguments: Sequence[str], registry: Registry) -> Request:
    """Return what the words ask for; raise ConfigurationError (one line) before anything runs or is written."""
    words = read_words(USAGE, arguments, keys=KEYS, overrides=None)
    preset, robot = words.required("planner"), words.keys.get("robot", "turtlebot3")
    chosen = [f"planner={preset}", f"robot={robot}", *words.overrides]
    sets = read_problem_sets(words.keys.get("problems", "v1"), registry)
    cells = compose_cells(sets, chosen)
    config = to_plain(cells.configs[0])
    space = search_space_of(preset, config["planner"]["name"], registry)
    check_search_space(space, config["planner"], registry)
    sampler = words.keys.get("sampler", space.sampler)
    if sampler not in SAMPLERS:
        raise ConfigurationError(f"sampler is {sampler}; allowed: {', '.join(SAMPLERS)}")
    seed = words.value("seed", NonNegativeInt, 0)
    plan = Plan(space, sampler, seed, read_budget(words.keys.get("budget", BUDGET)), sets)
    plan.check()
    problems = sets.facts(words.keys.get("problems", "v1"))
    objective = Objective(words.keys.get("objective", DEFAULT), _metric_names(config, registry))
    facts = {
        "planner": config["planner"]["name"],
        "preset": preset,
        "robot": robot,
        "words": [word for word in words.overrides if not key_value(word)[0].startswith("executor")],
        "fixed": _fixed_values(words.overrides, config["planner"]),
        "objective": objective.text,
        "problems": problems,
        "code": digest_code(config, registry).digest,
    }
    name = words.keys.get("preset", f"{preset}_tuned_{robot}")
    return Request(
        facts,
        plan,
        cells,
        plain_values(values_of(space, config["planner"])),
        objective,
        config["executor"],
        words.value("finalists", PositiveInt, FINALISTS),
        Path(words.keys.get("out", f"tunings/{preset}_{robot}_{seed}")),
        preset_path(Path(words.keys.get("conf", "conf")), name),
    )


def tune(request: Request, registry: Registry) -> None:
    """Carry out a request and write its results to its folder."""
    from arena_tuning.card import make_card
    from arena_tuning.judging import judge_search
    from arena_tuning.study import run_search

    check_free(request.preset, request.digest)
    with closing(registry.build("executor", request.executor)) as executor:
        driver = Driver(request.cells, executor, Journal(request.folder), request.objective, request.folder)
        driver.check(request.present, registry)
        search = run_search(request.plan, request.present, driver, request.folder, _say)
        judgement = judge_search(search, request.finalists, request.plan.sets, driver)
    card = make_card({**request.facts, "settings": request.digest}, request.plan, search, judgement)
    for line in write_results(request.folder, request.preset, card, request.plan, search):
        _say(line)


def _fixed_values(words: Sequence[str], planner: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the user's words set of the planner, which the preset keeps beside what is searched."""
    keys = [key_value(word)[0].removeprefix("planner.") for word in words if key_value(word)[0].startswith("planner.")]
    return {key: value_at(planner, key) for key in keys}


def _metric_names(config: Mapping[str, Any], registry: Registry) -> list[str]:
    packs = build_metrics(config, registry)
    return [metric_column(pack, metric) for pack, metrics in packs.items() for metric in metrics if metric.unit != TEXT]


def _say(line: str) -> None:
    print(line, flush=True)
