"""What races save and lose where robots drive: random sets of ORCA's values, a few seeds, small sets of problems.

usage: .venv/bin/python benchmarks/tuning/driven.py FOLDER [SEEDS]

Of each seed, eight sets of values drive all 32 problems of `v1`; the race of the eight is run on what was driven. Its
winner and the best of four finalists of all are compared on 16 problems of validation. FOLDER keeps what was driven.
"""

import sys
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from statistics import fmean

import optuna

from arena_core.hosting import load_registry, search_space_of, to_plain, values_of
from arena_tuning.driving import Driver, compose_cells
from arena_tuning.journal import Journal
from arena_tuning.objective import Objectives
from arena_tuning.problems import JudgingSet, problems_of, read_problem_sets
from arena_tuning.racing import Entrant, run_race
from arena_tuning.sampling import distributions_of, make_sampler, plain_values
from arena_tuning.study import order_problems

RACES, FINALISTS, BLOCKS, VALIDATION = 1, 4, [4, 8, 16, 32], 16
OBJECTIVE = "strict_success - 0.05 * min(collisions, 5) - 0.2 * known(time_to_goal, time_limit) / time_limit"
METRICS = ["strict_success", "collisions", "time_to_goal"]


def draw(space, seed, count):
    """Return random sets of values."""
    study = optuna.create_study(sampler=make_sampler("random", seed, count))
    return [plain_values(study.ask(distributions_of(space)).params) for _ in range(count)]


def winner_of(entrants, present, driver, problems):
    """Return what the best of the finalists is worth on validation, and how often it is a strict success."""
    finalists = sorted(entrants, key=lambda one: -one.advantage(present))[:FINALISTS]
    scores = driver.drive([one.values for one in finalists], problems)
    worths = [fmean(score[0] for score in found.values() if score) for found in scores]
    best = max(range(len(worths)), key=worths.__getitem__)
    rows = [driver.row(finalists[best].values, problem) for problem in problems]
    return worths[best], fmean(float(row["strict_success"]) for row in rows)


def study(seed, space, present, driver, sets):
    """Return the share of episodes that races took, and of the winners of both ways worth and strict success."""
    problems, validate = problems_of(sets, "tune", BLOCKS[-1]), problems_of(sets, "validate", VALIDATION)
    (base,) = driver.drive([present], problems)
    values = draw(space, seed, RACES * sets.entrants)
    full = [Entrant(one, dict(scores)) for one, scores in zip(values, driver.drive(values, problems), strict=True)]
    batches = [values[first : first + sets.entrants] for first in range(0, len(values), sets.entrants)]
    ordered = order_problems(problems, base)
    raced = [one for batch in batches for one in run_race(batch, BLOCKS, ordered, base, driver.drive)]
    share = sum(len(one.scores) for one in raced) / (len(values) * len(problems))
    whole = [one for one in raced if len(one.scores) == len(problems)]
    return share, winner_of(whole, base, driver, validate), winner_of(full, base, driver, validate)


def main():
    """Print what each seed shows."""
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    folder, registry = Path(sys.argv[1]), load_registry()
    folder.mkdir(parents=True, exist_ok=True)
    sets = replace(read_problem_sets("v1", registry), blocks=BLOCKS, validate=JudgingSet(4000000002, VALIDATION))
    cells = compose_cells(sets, ["planner=orca", "robot=jackal", "executor=serial"])
    config = to_plain(cells.configs[0])
    space = search_space_of("orca", "orca", registry)
    present = plain_values(values_of(space, config["planner"]))
    with closing(registry.build("executor", config["executor"])) as executor:
        driver = Driver(cells, executor, Journal(folder), Objectives(OBJECTIVE, METRICS), folder)
        for seed in range(int(sys.argv[2]) if len(sys.argv) > 2 else 5):
            share, raced, full = study(seed, space, present, driver, sets)
            told = ", ".join(f"{one[0]:.3f} ({one[1]:.3f})" for one in (raced, full))
            print(f"seed {seed}: {share:.3f} of the episodes; winner of races, of a full search: {told}", flush=True)


if __name__ == "__main__":
    main()
