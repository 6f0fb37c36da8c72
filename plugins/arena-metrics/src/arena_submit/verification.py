"""Whether a pack is true: its table against its records, and a random sample of its records
against episodes driven again.
"""

from __future__ import annotations

import math
import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from arena_core import ArenaError, EpisodeRecord, InputFileError, random_generator
from arena_core.commands import one_line
from arena_core.hosting import Finished, Job, Lost, Registry, digest_code
from arena_core.records import (
    build_metrics,
    cpu_kind,
    evaluate_record,
    installed_versions,
    is_success,
    read_record,
    record_digest,
    record_path,
    repeat_episodes,
)
from arena_submit.packing import Pack, PackedRun

CLOSE = 1e-9  # relative difference of a figure that another version of a library may make
AGREEING = 0.8  # share of the episodes driven again that have to end alike where they cannot be equal bit for bit
DRIVES_WITH = (
    "casadi",
    "llvmlite",
    "mujoco",
    "numba",
    "numpy",
    "onnxruntime",
    "scipy",
    "shapely",
)  # libraries whose numbers reach a record


@dataclass(frozen=True, slots=True)
class SampledEpisode:
    """An episode of a pack that is driven again."""

    run: PackedRun
    row: Mapping[str, str]

    @property
    def name(self) -> str:
        """Return what the episode is called in messages."""
        return f"{self.run.name} episode {self.row['episode']}"

    @property
    def record(self) -> str:
        """Return the name of its record within the pack."""
        return record_path(Path(self.run.name), int(self.row["episode"])).as_posix()


@dataclass(frozen=True, slots=True)
class RepeatedEpisode:
    """What came of an episode: whether it is the ``same`` bit for bit or ``agrees`` in its
    success at least, and how it went.
    """

    drawn: SampledEpisode
    same: bool
    agrees: bool
    told: str


@dataclass(frozen=True, slots=True)
class Verification:
    """What a verification found: rows that are not those of records, what became of the sample, and what is different
    here.

    ``elsewhere`` names versions, code or processor that are not those of the pack; where there are any, records need
    not be equal.
    """

    rows: int
    wrong_rows: Sequence[str]
    repeated: Sequence[RepeatedEpisode]
    elsewhere: Sequence[str]

    @property
    def required_count(self) -> int:
        """Return how many episodes of the sample have to agree."""
        return math.ceil(AGREEING * len(self.repeated)) if self.elsewhere else len(self.repeated)

    @property
    def is_valid(self) -> bool:
        """Return whether the pack is what it says: bit for bit where all is the same here, else by outcome."""
        agreeing = sum(one.agrees if self.elsewhere else one.same for one in self.repeated)
        return not self.wrong_rows and bool(self.repeated) and agreeing >= self.required_count


def verify_pack(pack: Pack, sample: int, seed: int, executor: Mapping[str, Any], registry: Registry) -> Verification:
    """Hold a pack's rows against its records, and ``sample`` of its episodes, drawn by ``seed``,
    against what is driven here.
    """
    wrong = [one for run in pack.runs for one in _wrong_rows(pack, run, registry)]
    drawn = sample_episodes(pack, sample, seed)
    elsewhere = list(
        dict.fromkeys(
            line
            for run in {id(one.run): one.run for one in drawn}.values()
            for line in _environment_changes(run, registry)
        )
    )
    return Verification(
        sum(len(run.rows) for run in pack.runs), wrong, list(_repeat_sample(pack, drawn, executor, registry)), elsewhere
    )


def sample_episodes(pack: Pack, sample: int, seed: int) -> list[SampledEpisode]:
    """Return so many of the episodes that left a record, in the pack's order; all of them where there are not more."""
    files = set(pack.archive.names)
    known = [one for run in pack.runs for one in (SampledEpisode(run, row) for row in run.rows) if one.record in files]
    chosen = random_generator(seed, pack.digest, "verify").choice(
        len(known), size=min(sample, len(known)), replace=False
    )
    return [known[i] for i in sorted(int(i) for i in chosen)]


def _wrong_rows(pack: Pack, run: PackedRun, registry: Registry) -> Iterator[str]:
    """Yield a line for each row that is not its record's; one of an error without a record is what it says."""
    packs = build_metrics(run.config, registry)
    for row in run.rows:
        one = SampledEpisode(run, row)
        if one.record not in pack.archive.names:
            if row.get("outcome") != "error":
                yield f"{one.name} has no record"
            continue
        wrong = _differing_column(row, evaluate_record(_read_packed_record(pack, one), packs))
        if wrong:
            yield f"{one.name}: {wrong} is not that of the record"


def _differing_column(written: Mapping[str, str], computed: Mapping[str, Any]) -> str:
    """Return the first column in which a row is not what its record gives; empty where all are."""
    for name, value in computed.items():
        text = written.get(name, "")
        if isinstance(value, float):
            alike = (text == "") if math.isnan(value) else _is_close(text, value)
        else:
            alike = text.removeprefix("'") == ("" if value is None else str(value)).removeprefix("'")
        if not alike:
            return one_line(name, 60)
    return ""


def _is_close(text: str, value: float) -> bool:
    try:
        return math.isclose(float(text), value, rel_tol=CLOSE, abs_tol=CLOSE)
    except ValueError:
        return False


def _read_packed_record(pack: Pack, one: SampledEpisode) -> EpisodeRecord:
    """Read an episode's record out of the pack."""
    timing = one.record.replace("/records/", "/timing/")
    with TemporaryDirectory(prefix="arena-pack-") as folder:
        pack.archive.unpack([name for name in (one.record, timing) if name in pack.archive.names], Path(folder))
        return read_record(Path(folder, one.record))


def _repeat_sample(
    pack: Pack, drawn: Sequence[SampledEpisode], executor: Mapping[str, Any], registry: Registry
) -> Iterator[RepeatedEpisode]:
    """Drive episodes again and yield how each compares."""
    with TemporaryDirectory(prefix="arena-verify-") as folder:
        asked = {(str(Path(folder, one.run.name)), int(one.row["episode"])): one for one in drawn}
        jobs = [Job(one.run.config, place, episode, _row_stage(one.row)) for (place, episode), one in asked.items()]
        for answer in repeat_episodes(jobs, executor, registry):
            one = asked[answer.job.folder, answer.job.episode]
            path = record_path(Path(answer.job.folder), answer.job.episode)
            yield _compare_repeat(one, _read_packed_record(pack, one), answer, path)


def _compare_repeat(one: SampledEpisode, then: EpisodeRecord, answer: Finished | Lost, path: Path) -> RepeatedEpisode:
    try:
        now = read_record(path)
    except InputFileError:
        reason = answer.reason if isinstance(answer, Lost) else str(answer.row.get("error", ""))
        return RepeatedEpisode(
            one, False, False, f"{_outcome_word(then)} then, cannot be driven here: {one_line(reason, 200)}"
        )
    same = record_digest(then) == record_digest(now)
    return RepeatedEpisode(
        one, same, same or is_success(then) == is_success(now), f"{_outcome_word(then)} then, {_outcome_word(now)} now"
    )


def _outcome_word(record: EpisodeRecord) -> str:
    outcome = str(record.meta["outcome"])
    return "success" if is_success(record) else "too many collisions" if outcome == "goal_reached" else outcome


def _row_stage(row: Mapping[str, str]) -> int | None:
    return int(row["stage"]) if row.get("stage", "").isdecimal() else None


def _environment_changes(run: PackedRun, registry: Registry) -> Iterator[str]:
    """Yield what of code, libraries, Python and processor is not as it was."""
    try:
        changed = digest_code(run.config, registry).changed(run.provenance["code"].get("parts") or {})
    except ArenaError as error:
        changed = [str(error)]
    if changed:
        yield f"other code: {one_line(', '.join(changed), 200)}"
    facts = run.provenance
    yield from environment_differences(
        {"versions": facts["versions"], "python": facts.get("python"), "cpu": facts["machine"].get("cpu")}
    )


def environment_differences(facts: Mapping[str, Any]) -> Iterator[str]:
    """Yield which ``versions`` of libraries, ``python`` and ``cpu`` are not those here: their numbers may
    differ in the last digit.
    """
    here = current_environment()
    for name in DRIVES_WITH:
        mine, theirs = here["versions"].get(name), facts["versions"].get(name)
        if mine != theirs:
            yield f"{name} {mine or 'absent'}, {one_line(str(theirs or 'absent'), 40)} there"
    for key, name in (("python", "Python"), ("cpu", "processor")):
        if here[key] != facts.get(key):
            yield f"{name} {here[key]}, {one_line(str(facts.get(key) or 'unknown'), 120)} there"


def current_environment() -> dict[str, Any]:
    """Return what records depend on beside the code: ``installed_versions`` of libraries,
    ``python``, and the kind of ``cpu``.
    """
    found = installed_versions()
    return {
        "versions": {name: found[name] for name in DRIVES_WITH if name in found},
        "python": platform.python_version(),
        "cpu": cpu_kind(),
    }
