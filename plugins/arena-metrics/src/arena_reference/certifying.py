"""Certificates of the problems of runs: each driven once, by the clairvoyant, whoever else faced the problem."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from typing import Any

from arena_core import ArenaError, EpisodeRecord, Run
from arena_core.commands import one_line, print_notice
from arena_core.hosting import Job, Lost, Registry, compose, digest_code, load_registry, to_plain
from arena_core.records import Reference, read_record, record_path, repeat_episodes
from arena_reference.findings import CERTIFICATES, Finding, check_simulated, compare, keep_findings, known_problems

PROBLEM = ("robot", "world", "pedestrians", "task", "simulator", "seed")  # parts of a configuration that make a problem
CHOSEN = ("planner", "localizer", "timing", "recording", "replan", "executor")
TOLD = 10  # times that progress is told
WORDS = ("planner=clairvoyant", "localizer=ground_truth", "timing.mode=ideal")


@dataclass(frozen=True, slots=True)
class Wanted:
    """An episode of a run, the digest of the code that solves its problem, and that of both; the ``robots`` of its team
    have episodes in a row.
    """

    run: Run
    episode: int
    stage: int | None
    code: str
    problem: str
    robots: int = 1

    @property
    def certificate(self) -> Path:
        """Return where its certificate's record lies."""
        return record_path(self.run.folder / CERTIFICATES, self.episode)

    @property
    def first(self) -> int:
        """Return the episode of the first robot of its team."""
        return self.episode - self.episode % self.robots


class ClairvoyantReference(Reference):
    """Certifies the problems of runs, as ``arena reference`` does."""

    def refer(self, folders: Sequence[Path], executor: Mapping[str, Any]) -> None:
        """Write certificates and findings beside the runs' records."""
        reference_runs([Run(folder) for folder in folders], executor, load_registry())


def reference_runs(runs: Sequence[Run], executor: Mapping[str, Any], registry: Registry) -> dict[Run, list[Finding]]:
    """Certify every problem of some runs and write a table beside the records of each; return the findings.

    What is certified already, with the same code, is not driven again.
    """
    wanted = [one for run in runs for one in episodes_of(run, registry)]
    place_known(wanted)
    pending = {one.problem: one for one in wanted if not one.certificate.is_file()}
    _drive(list(pending.values()), executor, registry)
    changed = check_driven(list(pending.values()))
    known = [one for one in wanted if one.problem not in changed]
    share_certificates(known)
    found: dict[Run, list[Finding]] = {run: [] for run in runs}
    for one in known:
        if one.certificate.is_file():
            found[one.run].append(_finding(one))
    for run, findings in found.items():
        keep_findings(run.folder, findings, digest_code(certificate_config(run.config), registry).digest)
    return found


def episodes_of(run: Run, registry: Registry) -> Iterator[Wanted]:
    """Yield the finished episodes of a run."""
    rows = run.episodes.to_dict("records")
    robots = team_size(rows)
    for record in (record_path(run.folder, int(row["episode"])) for row in rows[:1]):
        if record.is_file():
            check_simulated(run.folder, read_record(record))
            check_has_goals(run.folder, read_record(record))
    config = certificate_config(run.config)
    code = digest_code(config, registry).digest
    problem = {part: config[part] for part in PROBLEM}
    for row in rows:
        stage = int(row["stage"]) if str(row.get("stage", "")) not in ("", "nan") else None
        if row["outcome"] == "error" and not record_path(run.folder, int(row["episode"])).is_file():
            continue
        text = json.dumps(
            [problem, int(row["episode"]), stage, str(row.get("scenario_hash", "")), code], sort_keys=True
        )
        yield Wanted(run, int(row["episode"]), stage, code, blake2b(text.encode(), digest_size=8).hexdigest(), robots)


def team_size(rows: Sequence[Mapping[str, Any]]) -> int:
    """Return how many robots the scenarios of a run have, by the rows of its table."""
    return 1 + max((int(row["member"]) for row in rows if str(row.get("member", "")) not in ("", "nan")), default=0)


def check_has_goals(folder: Path, record: EpisodeRecord) -> None:
    """Raise ArenaError for an episode of robots that were sent on until the time limit."""
    if "errands" in record.meta.get("team", {}):
        raise ArenaError(
            f"{folder}: its robots were sent from place to place until the time limit; allowed: runs in which each "
            "robot has one goal"
        )


def certificate_config(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return a run's configuration with the clairvoyant in its planner's place."""
    robot = config.get("choices", {}).get("robot") or config["robot"]["name"]
    clairvoyant = to_plain(compose([*WORDS, f"robot={robot}"]))
    changed = {part: clairvoyant[part] for part in CHOSEN}
    choices = {**config.get("choices", {}), "planner": "clairvoyant", "localizer": "ground_truth"}
    return {**config, **changed, "choices": choices, "stop_on_collision": False}


def place_known(wanted: Sequence[Wanted]) -> None:
    """Remove certificates of other problems or other code, and copy those that other runs have of the same one."""
    solved = {run: known_problems(run.folder) for run in {one.run for one in wanted}}
    for one in wanted:
        if one.certificate.is_file() and not _is_of(one, solved[one.run].get(one.episode)):
            one.certificate.unlink()
    share_certificates(wanted)


def check_driven(driven: Sequence[Wanted]) -> set[str]:
    """Return the problems whose certificates were driven just now by code that had changed meanwhile, and say so: they
    are kept, and count for whoever asks next.
    """
    changed = {one.problem for one in driven if one.certificate.is_file() and not _is_of(one, None)}
    if changed:
        print(
            f"{len(changed)} certificates do not count yet: the code changed while they were driven; allowed: "
            "`arena reference` again",
            file=sys.stderr,
        )
    return changed


def share_certificates(wanted: Sequence[Wanted]) -> None:
    """Copy the certificates that are there to the other runs that face the same problem."""
    known: dict[str, Path] = {}
    for one in wanted:
        if one.certificate.is_file():
            known.setdefault(one.problem, one.certificate)
    for one in wanted:
        if one.problem in known and not one.certificate.is_file():
            one.certificate.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(known[one.problem], one.certificate)


def _is_of(one: Wanted, problem: str | None) -> bool:
    """Return whether a certificate is of this problem and code; ``problem`` is what findings say of it, None where
    whoever drove it was interrupted before they were written.
    """
    if problem is not None:
        return problem == one.problem
    return bool(read_record(one.certificate).meta["columns"]["code"] == one.code)


def _drive(wanted: Sequence[Wanted], executor: Mapping[str, Any], registry: Registry) -> None:
    """Drive the certificates that are wanted; say which could not be."""
    configs = {one.run: certificate_config(one.run.config) for one in wanted}
    teams = {(one.run, one.first): one for one in wanted}
    jobs = [
        Job(configs[run], str(run.folder / CERTIFICATES), first, one.stage, one.robots)
        for (run, first), one in teams.items()
    ]
    for number, answer in enumerate(repeat_episodes(jobs, executor, registry) if jobs else (), 1):
        place = f"{answer.job.folder}: episode {answer.job.episode}"
        if isinstance(answer, Lost):
            print(f"{place} was lost: {one_line(answer.reason)}", file=sys.stderr)
        elif answer.row["outcome"] == "error":
            print(f"{place} failed: {answer.row['error']}", file=sys.stderr)
        if number * TOLD // len(jobs) > (number - 1) * TOLD // len(jobs):
            print_notice(f"{number} of {len(jobs)} certificates")


def _finding(one: Wanted) -> Finding:
    record = read_record(record_path(one.run.folder, one.episode))
    team = [record_path(one.run.folder / CERTIFICATES, one.first + member) for member in range(one.robots)]
    together = [read_record(path) if path.is_file() else None for path in team]
    return compare(one.episode, record, together, one.problem, reacts=people_react(one.run.config))


def people_react(config: Mapping[str, Any]) -> bool:
    """Return whether people of a configuration walk elsewhere because of the robot."""
    return bool(config["pedestrians"].get("reaction", "ignore") != "ignore")
