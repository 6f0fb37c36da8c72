"""The contracts of rewards and observation encoders."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from arena_core.contracts.learning import ObservationBatch, ObservationEncoder, ObservationField, Reward, ScanMemory
from arena_core.testing import samples
from arena_core.testing.facts import Facts
from arena_core.testing.steps import join_batches, transition
from arena_core.values.geometry import Twist
from arena_core.values.robot import Robot
from arena_core.values.sensing import Observation


def check_reward(reward: Reward, body: Robot) -> Facts:
    """Judge some steps, together and one by one."""
    together = transition(5)
    values = reward.reward(together)
    yield "it gives each robot a finite number", values.shape == (5,) and bool(np.isfinite(values).all())
    yield "the same step gives the same reward", bool((reward.reward(together) == values).all())
    alone = [reward.reward(transition(5, slice(k, k + 1)))[0] for k in range(5)]
    yield "a robot among others gets what it gets alone", bool((np.array(alone) == values).all())


def check_observation_encoder(encoder: ObservationEncoder, body: Robot) -> Facts:
    """Encode what a planner sees, together and one by one."""
    fields, views = encoder.layout(), samples.views(body)
    batches, rows, recalled = [], [], encoder.blank(1)
    for k, view in enumerate(views):
        command = Twist(0.1, 0.0, 0.05 * k)
        batches.append(
            ObservationBatch.of(
                view, command, _make_memory(encoder, views[:k], view), recalled, tracked=encoder.tracked
            )
        )
        rows.append(encoder.encode(batches[-1]))
        recalled = rows[-1] if encoder.recurrent else recalled
    size = sum(field.size for field in fields)
    yield (
        "an observation is float32 and as long as the layout says",
        all(r.shape == (1, size) and r.dtype == np.float32 for r in rows),
    )
    yield "fields have names of their own, a unit, bounds and a meaning", _well_described(fields)
    low = np.concatenate([np.full(field.size, field.low, np.float32) for field in fields])
    high = np.concatenate([np.full(field.size, field.high, np.float32) for field in fields])
    yield "every number is within its bounds", all(bool(((r >= low) & (r <= high)).all()) for r in rows)
    together = encoder.encode(join_batches(batches))
    yield "an observation among others gives what it gives alone", bool((together == np.concatenate(rows)).all())
    yield "the result is new each time", not np.shares_memory(together, encoder.encode(join_batches(batches)))


def _make_memory(encoder: ObservationEncoder, before: Sequence[Observation], view: Observation) -> ScanMemory:
    """Return the memory of a robot that saw some views before this one."""
    memory = ScanMemory(encoder.lookback, 1, len(view.scan.ranges))
    for step, seen in enumerate((*before, view)):
        ranges, poses = seen.scan.ranges[None], seen.pose.array()[None]
        memory.remember(ranges, poses) if step else memory.begin(np.zeros(1, np.int64), ranges, poses)
    return memory


def _well_described(fields: Sequence[ObservationField]) -> bool:
    named = len({field.name for field in fields}) == len(fields)
    return named and all(field.size > 0 and field.low < field.high and field.unit and field.meaning for field in fields)
