"""How much a race saves, and what it loses, against driving every set of values on all problems.

usage: .venv/bin/python benchmarks/tuning/racing.py [REPLICATIONS]

No robot drives: an episode is a success by chance, with half of the variance that of its problem, so that the true
success of what is chosen is known. Sets of values have a true success of 0.70 +- 0.12, the present ones of 0.80.
"""

import random
import sys
from statistics import NormalDist, fmean

from arena_core.hosting import load_registry
from arena_tuning.problems import problems_of, read_problem_sets
from arena_tuning.racing import Entrant, run_race
from arena_tuning.study import order_problems

RACES, FINALISTS, PRESENT = 10, 4, 0.80
NORMAL = NormalDist()


class Chance:
    """Scores of sets of values whose true success is known; counts the episodes."""

    def __init__(self, seed, worths):
        self.seed, self.worths, self.episodes = seed, worths, 0

    def __call__(self, sets_of_values, problems):
        """Return the scores of each set of values on some problems."""
        self.episodes += len(sets_of_values) * len(problems)
        return [{problem: self.score(values["number"], problem) for problem in problems} for values in sets_of_values]

    def score(self, number, problem):
        """Return what an episode is worth: success, less a little time."""
        hardness = random.Random(f"{self.seed} {problem}").gauss(0.0, 1.0)
        luck = random.Random(f"{self.seed} {problem} {number}")
        able = NORMAL.inv_cdf(self.worths[number]) * 2.0**0.5
        return (float(able > hardness + luck.gauss(0.0, 1.0)) - 0.05 * luck.random(),)


def study(seed, sets):
    """Return the share of episodes that races took, and the true success of their winner and of a full search's."""
    draw = random.Random(seed)
    count = RACES * sets.entrants
    drive = Chance(seed, [PRESENT, *(min(0.98, max(0.2, draw.gauss(0.70, 0.12))) for _ in range(count))])
    problems, validate = problems_of(sets, "tune", sets.searched), problems_of(sets, "validate", sets.validate.problems)
    (present,) = drive([{"number": 0}], problems)
    problems = order_problems(problems, present)
    values, drive.episodes = [{"number": number} for number in range(1, count + 1)], 0
    batches = [values[first : first + sets.entrants] for first in range(0, count, sets.entrants)]
    raced = [one for batch in batches for one in run_race(batch, sets.blocks, problems, present, drive)]
    share = drive.episodes / (count * len(problems))
    full = [Entrant(one, scores) for one, scores in zip(values, drive(values, problems), strict=True)]
    winners = []
    for entrants in ([one for one in raced if len(one.scores) == len(problems)], full):
        finalists = sorted(entrants, key=lambda one: -one.advantage(present))[:FINALISTS]
        scores = drive([one.values for one in finalists], validate)
        best = max(range(len(finalists)), key=lambda place: fmean(score for (score,) in scores[place].values()))
        winners.append(drive.worths[finalists[best].values["number"]])
    return share, *winners


def main():
    """Print what many replications show."""
    sets = read_problem_sets("v1", load_registry())
    found = [study(seed, sets) for seed in range(int(sys.argv[1]) if len(sys.argv) > 1 else 100)]
    shares, raced, full = (list(one) for one in zip(*found, strict=True))
    worse = sum(theirs - mine > 0.03 for mine, theirs in zip(raced, full, strict=True))
    print(f"episodes of races, as a share of a full search: {fmean(shares):.3f}")
    print(f"true success of the winner: {fmean(raced):.3f} by races, {fmean(full):.3f} by a full search")
    print(f"worse by more than 0.03 in {worse} of {len(found)}")


if __name__ == "__main__":
    main()
