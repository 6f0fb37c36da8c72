"""``executor=ray``: jobs go to the machines of a cluster a few at a time, and come home as they are over."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from time import monotonic
from typing import Any, TypeVar

from arena_core.commands import interrupts, print_notice
from arena_core.hosting import (
    Budgets,
    Delivery,
    Executor,
    Job,
    Lost,
    OtherCode,
    ProcessExecutor,
    RunFolderError,
    RunStopped,
    require_extra,
    store_delivery,
)
from arena_core.parameters import Positive, PositiveInt, Workers
from arena_ray.cluster import Cluster, LostMachine, RayNode
from arena_ray.machine import THREADS, Machine

T = TypeVar("T")
LOOK_EVERY = 0.5  # s between two looks at Ctrl-C while no answer comes
PATIENCE = 2.0  # s after which a machine without news says so
MEET_EVERY = 5.0  # s between two looks for machines that have joined
AHEAD = 2  # jobs for each worker that a machine has at a time: one under way, one waiting
ENDED_WITHIN = 10.0  # s that machines may take to end their workers


@dataclass(slots=True, eq=False)
class Member:
    """A machine at work: its actor, the call that is out, since when (s), and its jobs with the
    how manieth attempt each is.
    """

    place: RayNode
    actor: Any
    workers: int
    call: Any
    since: float
    greeted: bool = False
    jobs: dict[tuple[str, int, int | None], tuple[Job, int]] = field(default_factory=dict)


class RayExecutor(Executor):
    """Run jobs in supervised workers on each machine of a Ray cluster; what they write comes home with the answers.

    A machine that is lost costs nothing but time: its jobs are done elsewhere, up to ``attempts`` times. One with other
    code, or without room on its disk, is left out. Checks that come before a run are made at home, in one supervised
    process.
    """

    def __init__(
        self, address: str | None, workers: Workers | None, silence: Positive, attempts: PositiveInt, budgets: Budgets
    ) -> None:
        require_extra("executor=ray", ["ray"], "arena-cluster[ray]")
        self._address, self._workers, self._silence, self._attempts, self._budgets = (
            address,
            workers,
            silence,
            attempts,
            budgets,
        )
        self._cluster: Cluster | None = None
        self._members: dict[str, Member] = {}
        self._left_out: set[str] = set()
        self._met = -MEET_EVERY
        self._why = "it has no machine with a CPU"

    def prepare(self, check: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Run checks in a process of this machine."""
        at_home = ProcessExecutor(1, self._budgets)
        try:
            yield from at_home.prepare(check, jobs)
        finally:
            at_home.close()

    def map(self, work: Callable[[Job], T], jobs: Sequence[Job]) -> Iterator[T | Lost]:
        """Yield answers as they come home, and ``Lost`` for a job that cannot be
        finished; raise what ``work`` raises.
        """
        waiting = deque((job, 1) for job in jobs)
        self._cluster = self._cluster or Cluster(self._address, self._workers)
        done = False
        try:
            while waiting or any(member.jobs for member in self._members.values()):
                self._join_machines(self._cluster)
                yield from self._poll_machines(self._cluster, work, waiting)
                interrupts.check()
            done = True
        finally:
            if not done:  # what machines are still at is no one's any more
                for member in list(self._members.values()):
                    self._give_up(self._cluster, member)

    def close(self) -> None:
        """End the machines' workers, and Ray where it was begun here."""
        if self._cluster is not None:
            ends = [member.actor.close.remote() for member in self._members.values()]
            until = monotonic() + ENDED_WITHIN
            while (left := until - monotonic()) > 0.0 and (over := self._cluster.ready_calls(ends, left)):
                ends = [end for end in ends if end not in over]
            for member in list(self._members.values()):
                self._give_up(self._cluster, member)
            self._cluster.close()
            self._cluster = None

    def _join_machines(self, cluster: Cluster) -> None:
        """Put an actor on every machine that has joined."""
        if monotonic() - self._met < MEET_EVERY and self._members:
            return
        self._met = monotonic()
        for place in cluster.alive_nodes():
            if place.id not in self._members and place.id not in self._left_out:
                workers = self._workers or place.cpus
                actor = cluster.actor(Machine, place, workers, workers, self._budgets, os.environ.get(THREADS))
                self._members[place.id] = Member(place, actor, workers, actor.name.remote(), monotonic())
        if not self._members:
            raise RunStopped(
                f"no machine of Ray is left ({self._why}); finished episodes are kept, resume=true continues"
            )

    def _poll_machines(
        self, cluster: Cluster, work: Callable[[Job], Any], waiting: deque[tuple[Job, int]]
    ) -> Iterator[Any]:
        """Yield what has come home; give machines that have answered their next jobs."""
        by_call = {member.call: member for member in self._members.values()}
        for call in cluster.ready_calls(list(by_call), LOOK_EVERY):
            member = by_call[call]
            try:
                deliveries = self._read_answer(cluster, member)
            except (LostMachine, OtherCode, RunFolderError) as error:
                yield from self._drop_machine(cluster, member, error, waiting)
                continue
            member.since = monotonic()
            self._feed_machine(member, work, waiting)
            for delivery in deliveries:
                yield store_delivery(delivery)
        for member in [
            one for one in self._members.values() if one.greeted and monotonic() - one.since > self._silence
        ]:
            silent = LostMachine(f"it has said nothing for {self._silence:g} s")
            yield from self._drop_machine(cluster, member, silent, waiting)

    def _read_answer(self, cluster: Cluster, member: Member) -> list[Delivery]:
        """Return what a machine hands over; its first answer is its name."""
        answer = cluster.answer(member.call)
        if not member.greeted:
            member.greeted = True
            return []
        for delivery in answer:
            member.jobs.pop(_job_key(delivery.job), None)
        return list(answer)

    def _feed_machine(self, member: Member, work: Callable[[Job], Any], waiting: deque[tuple[Job, int]]) -> None:
        """Ask a machine for its next turn, with so many new jobs that none of its workers waits."""
        room = AHEAD * member.workers - len(member.jobs)
        taken = [waiting.popleft() for _ in range(min(room, len(waiting)))]
        member.jobs |= {_job_key(job): (job, attempt) for job, attempt in taken}
        member.call = member.actor.poll_work.remote(work, [job for job, _ in taken], PATIENCE)

    def _drop_machine(
        self, cluster: Cluster, member: Member, error: Exception, waiting: deque[tuple[Job, int]]
    ) -> Iterator[Lost]:
        """Go on without a machine: its jobs are done again, or lost where that was tried often enough."""
        self._why = str(error)
        left = "is lost" if isinstance(error, LostMachine) else "is left out"
        print_notice(f"machine {member.place.name or member.place.id[:8]} ({member.place.id[:8]}) {left}: {error}")
        self._give_up(cluster, member)
        self._left_out.add(member.place.id)
        counts = isinstance(error, LostMachine)
        for job, attempt in reversed(member.jobs.values()):
            if counts and attempt >= self._attempts:
                yield Lost(job, f"its machine was lost {attempt} times, the last time because {error}")
            else:
                waiting.appendleft((job, attempt + counts))

    def _give_up(self, cluster: Cluster, member: Member) -> None:
        self._members.pop(member.place.id, None)
        with suppress(Exception):  # it may be gone with its machine
            cluster.end(member.actor)


def _job_key(job: Job) -> tuple[str, int, int | None]:
    return job.folder, job.episode, job.stage
