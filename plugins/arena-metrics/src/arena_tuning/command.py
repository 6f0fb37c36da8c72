"""``arena tune``: from a planner, or the stack that guides one, and a robot to a preset with its card."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from hashlib import blake2b
from json import dumps
from pathlib import Path
from time import perf_counter
from typing import Any, ClassVar

from arena_core import ArenaError, ConfigurationError
from arena_core.commands import Command, Words, complete_overrides, interrupts, key_value, read_words
from arena_core.files import options_of
from arena_core.hosting import (
    Registry,
    compose,
    digest_code,
    load_registry,
    lock_folder,
    require_extra,
    to_plain,
    values_of,
)
from arena_core.parameters import NonNegativeInt, PositiveInt
from arena_core.records import TEXT, build_metrics, metric_column
from arena_tuning.budget import read_budget
from arena_tuning.costing import COST_NAMES, KNOWN
from arena_tuning.driving import Cells, Driver, compose_cells
from arena_tuning.folder import open_folder
from arena_tuning.journal import Journal, Values
from arena_tuning.objective import DEFAULT, Objectives
from arena_tuning.preset import check_free, preset_path
from arena_tuning.problems import read_problem_sets
from arena_tuning.results import write_results, write_times
from arena_tuning.sampling import SAMPLERS, plain_values
from arena_tuning.study import Plan
from arena_tuning.subject import DRIVER, PARTS, PLANNER, STACK, Subject

USAGE = (
    "arena tune planner=NAME | stack [planner=NAME] robot=NAME [budget=2000 or budget=20min] [seed=0] "
    "[objective=EXPRESSION or objective=[A,B]] [problems=v1] [sampler=tpe] [finalists=4] [preset=NAME] [conf=DIR] "
    "[out=DIR] [resume=true] [KEY=VALUE ...]"
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
    objective: Objectives
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
    """Tune a planner for a robot, or the stack that guides it."""

    help: ClassVar[str] = "values of a planner, or of its stack, that suit a robot: arena tune planner=teb robot=jackal"
    checks: ClassVar[str] = "tune"
    kept: ClassVar[str] = "finished episodes are kept, resume=true (with the same words) goes on from there"

    def run(self, arguments: Sequence[str]) -> int:
        """Search, choose, judge, and write what came of it; a preset only where it is better."""
        if any(word in ("-h", "--help") for word in arguments):
            print(f"usage: {USAGE}")
            return 0
        require_extra("arena tune", NEEDED, "arena-metrics[tune]")
        words = _read_words(arguments)
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
            return [f"planner={name}" for name in options_of("tune", load_registry().manager) if name != STACK]
        if word.startswith("sampler="):
            return [f"sampler={name}" for name in SAMPLERS]
        return [STACK, *(f"{key}=" for key in OWN), "resume=true", *complete_overrides(words, word)]

    def check(self, name: str, overrides: Sequence[str]) -> int:
        """Check a search space with the values for each robot, or for ``robot=NAME``; print what held."""
        registry = load_registry()
        subject = Subject(STACK, DRIVER) if name == STACK else Subject(PLANNER, name)
        robots = [word for word in overrides if word.startswith("robot=")]
        others = [word for word in overrides if word not in robots]
        for robot in robots or [f"robot={one}" for one in options_of("robot", registry.manager) if "/" not in one]:
            try:
                composed = compose(subject.words(robot.partition("=")[2], others))
                subject.check(to_plain(composed), registry)
            except ArenaError as error:
                print(f"BROKEN tune={name} ({robot}): {error}")
                return 1
        print(f"ok tune={name}: its ranges are valid and hold the {subject.kind}'s values")
        return 0


def read_request(arguments: Sequence[str], registry: Registry) -> Request:
    """Return what the words ask for; raise ConfigurationError (one line) before anything runs or is written."""
    words = _read_words(arguments)
    subject, robot = _subject_of(words), words.keys.get("robot", "turtlebot3")
    sets = read_problem_sets(words.keys.get("problems", "v1"), registry)
    cells = compose_cells(sets, subject.words(robot, words.overrides), subject.place)
    config = to_plain(cells.configs[0])
    space, left_out = subject.space(config, registry)
    sampler = words.keys.get("sampler", space.sampler)
    if sampler not in SAMPLERS:
        raise ConfigurationError(f"sampler is {sampler}; allowed: {', '.join(SAMPLERS)}")
    seed = words.value("seed", NonNegativeInt, 0)
    objective = Objectives(words.keys.get("objective", DEFAULT), [*_metric_names(config, registry), *COST_NAMES])
    budget = read_budget(words.keys.get("budget", BUDGET))
    plan = Plan(space, sampler, seed, budget, sets, len(objective.parts))
    plan.check()
    problems = sets.facts(words.keys.get("problems", "v1"))
    facts = {
        **_facts_of(subject, cells, left_out),
        "robot": robot,
        "words": [word for word in words.overrides if not key_value(word)[0].startswith("executor")],
        "fixed": subject.fixed(words.overrides, config),
        "objective": objective.text,
        "problems": problems,
        "code": digest_code(config, registry).digest,
    }
    name = words.keys.get("preset", subject.preset_name(robot))
    return Request(
        facts,
        plan,
        cells,
        plain_values(values_of(space, subject.config(config))),
        objective,
        config["executor"],
        words.value("finalists", PositiveInt, FINALISTS),
        Path(words.keys.get("out", f"tunings/{subject.name}_{robot}_{seed}")),
        preset_path(Path(words.keys.get("conf", "conf")) / subject.kind, name),
    )


def tune(request: Request, registry: Registry) -> None:
    """Carry out a request and write its results to its folder."""
    from arena_tuning.card import make_card
    from arena_tuning.judging import judge_search
    from arena_tuning.study import run_search

    check_free(request.preset, request.digest)
    for key in request.facts.get("left_out", ()):
        _say(f"{key} is left out: not there, or planner {request.facts['planner']} has its own")
    with closing(registry.build("executor", request.executor)) as executor:
        driver = Driver(request.cells, executor, Journal(request.folder), request.objective, request.folder)
        driver.check(request.present, registry)
        began = perf_counter()
        search = run_search(request.plan, request.present, driver, request.folder, _say)
        judgement = judge_search(search, request.finalists, request.plan.sets, driver)
    objectives = [one.text for one in request.objective.parts]
    twins = driver.journal.count(KNOWN)
    facts = {**request.facts, "settings": request.digest, "objectives": objectives, "twins": twins}
    card = make_card(facts, request.plan, search, judgement)
    _say(write_times(request.folder, driver.seconds, perf_counter() - began))
    for line in write_results(request.folder, request.preset, card, request.plan, search):
        _say(line)


def _read_words(arguments: Sequence[str]) -> Words:
    """Return the words; raise ConfigurationError for a name that is nothing that can be tuned."""
    words = read_words(USAGE, arguments, names=None, keys=KEYS, overrides=None)
    if words.names not in ((), (STACK,)):
        raise ConfigurationError(f"arguments are {' '.join(words.names)}; allowed: {USAGE}")
    return words


def _subject_of(words: Words) -> Subject:
    if words.names:
        return Subject(STACK, words.keys.get("planner", DRIVER))
    return Subject(PLANNER, words.required("planner"))


def _facts_of(subject: Subject, cells: Cells, left_out: Sequence[str]) -> dict[str, Any]:
    """Return what a card says of what is tuned: the planner and its preset; of a stack its parts, and who drives."""
    if subject.kind == PLANNER:
        return {"planner": cells.configs[0].planner.name, "preset": subject.preset}
    parts = {part: cells.choices[0][part] for part in PARTS}
    return {"planner": subject.preset, "preset": STACK, "parts": parts, "left_out": list(left_out)}


def _metric_names(config: Mapping[str, Any], registry: Registry) -> list[str]:
    packs = build_metrics(config, registry)
    return [metric_column(pack, metric) for pack, metrics in packs.items() for metric in metrics if metric.unit != TEXT]


def _say(line: str) -> None:
    print(line, flush=True)
