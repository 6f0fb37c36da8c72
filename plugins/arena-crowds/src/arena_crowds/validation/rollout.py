"""How far simulated people get from recorded ones in 4.8 s, against people who just walk on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import Crowd, InputFileError, PedestrianModel, PedestrianSpec, Scenario, World
from arena_crowds.replay.recordings import Recording, read_recording
from arena_crowds.validation.findings import Findings
from arena_crowds.validation.floor_plan import Area, floor_world, make_scenario
from arena_crowds.validation.walks import Lead, simulate_walks

Floats = NDArray[np.float64]

INTERVAL = 0.4  # s between samples
OBSERVED, PREDICTED = 8, 12  # samples, of which the last observed one is the start
RADIUS = 0.2  # m
SLOWEST = 0.1  # m/s: no one's own speed is below
MARGIN = 20.0  # m of free floor round the recording, of which no walls are known
AT_ONCE = 256  # worlds of a batch


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """An instant of a recording: who is there (walks, (P,)), where and how fast, own speeds and goals;
    ``asked`` are to be predicted.
    """

    time: float
    walks: NDArray[np.int64]
    positions: Floats
    velocities: Floats
    speeds: Floats
    goals: Floats
    asked: NDArray[np.bool_]


def run(models: Mapping[str, PedestrianModel], recordings: Path | None) -> Findings:
    """Predict every walk of ucy/zara01 that is long enough, from every sample on."""
    path = recordings / "ucy" / "zara01" / "obsmat.txt.gz" if recordings else None
    if path is None:
        raise InputFileError("rollout needs a recording; allowed: recordings=DIR with DIR/ucy/zara01/obsmat.txt.gz")
    recording = read_recording(path, "obsmat")
    found = find_moments(recording)
    truth = np.concatenate([_recorded_positions(recording, moment) for moment in found])
    guesses = {
        "constant velocity": _straight_predictions(found, to_goal=False),
        "straight to the goal": _straight_predictions(found, to_goal=True),
    }
    for name, model in models.items():
        guesses[f"{name}, others as recorded"] = predict_individually(model, recording, found)
        guesses[f"{name}, all simulated"] = predict_jointly(model, recording, found)
    errors = {name: np.linalg.norm(guess - truth, axis=-1) for name, guess in guesses.items()}
    return Findings(
        [_error_row(name, own) for name, own in errors.items()], lambda figure: _draw_figure(figure, errors)
    )


def find_moments(recording: Recording) -> list[Moment]:
    """Return every sample at which a person has been observed long enough and stays long enough."""
    samples = np.arange(int(recording.duration / INTERVAL + 0.5) + 1) * INTERVAL
    return [moment for time in samples if (moment := _make_moment(recording, float(time))).asked.any()]


def _make_moment(recording: Recording, time: float) -> Moment:
    walks = np.flatnonzero((recording.begins <= time + 1e-6) & (recording.ends >= time - 1e-6))
    back = np.stack([recording.at(walks, np.full(len(walks), time - k * INTERVAL))[0] for k in range(OBSERVED)])
    steps = back[:-1] - back[1:]
    lengths = np.linalg.norm(steps, axis=-1)
    seen = np.isfinite(lengths).sum(axis=0)
    velocities = np.where(np.isfinite(steps[0]), steps[0] / INTERVAL, recording.at(walks, np.full(len(walks), time))[1])
    speeds = np.where(
        seen > 0, np.nansum(lengths, axis=0) / np.maximum(seen, 1) / INTERVAL, np.linalg.norm(velocities, axis=-1)
    )
    stays = recording.ends[walks] >= time + PREDICTED * INTERVAL - 1e-6
    goals = recording.positions[recording.first[walks + 1] - 1]
    return Moment(time, walks, back[0], velocities, np.maximum(speeds, SLOWEST), goals, (seen == OBSERVED - 1) & stays)


def _recorded_positions(recording: Recording, moment: Moment) -> Floats:
    """Return where those asked for really were, (K, PREDICTED, 2)."""
    walks = moment.walks[moment.asked]
    times = moment.time + INTERVAL * np.arange(1, PREDICTED + 1)
    positions, _ = recording.at(np.repeat(walks, PREDICTED), np.tile(times, len(walks)))
    return positions.reshape(len(walks), PREDICTED, 2)


def _straight_predictions(found: list[Moment], *, to_goal: bool) -> Floats:
    """Return predictions of people who keep their last velocity, or walk straight to
    their goals at their own speeds.
    """
    ahead = INTERVAL * np.arange(1, PREDICTED + 1)[:, None]
    guesses = []
    for moment in found:
        for k in np.flatnonzero(moment.asked):
            way = moment.goals[k] - moment.positions[k]
            length = max(float(np.hypot(*way)), 1e-9)
            course = (
                np.minimum(moment.speeds[k] * ahead / length, 1.0) * way if to_goal else ahead * moment.velocities[k]
            )
            guesses.append(moment.positions[k] + course)
    return np.array(guesses)


def predict_jointly(model: PedestrianModel, recording: Recording, found: list[Moment]) -> Floats:
    """Return predictions in which everybody who is there is simulated."""
    guesses = _simulate_moments(model, recording, found, [None] * len(found))
    return np.concatenate([guess[moment.asked] for guess, moment in zip(guesses, found, strict=True)])


def predict_individually(model: PedestrianModel, recording: Recording, found: list[Moment]) -> Floats:
    """Return predictions of each person alone, among others who walk as recorded."""
    pairs = [(moment, int(k)) for moment in found for k in np.flatnonzero(moment.asked)]
    guesses = _simulate_moments(model, recording, [moment for moment, _ in pairs], [k for _, k in pairs])
    return np.array([guess[k] for guess, (_, k) in zip(guesses, pairs, strict=True)])


def _simulate_moments(
    model: PedestrianModel, recording: Recording, found: list[Moment], only: list[Any]
) -> list[Floats]:
    """Return what becomes of everybody in every world, each (P, PREDICTED, 2); where ``only``
    names one, the others are led.
    """
    low, high = recording.positions.min(axis=0) - MARGIN, recording.positions.max(axis=0) + MARGIN
    world, guesses = floor_world("street", (Area(low[0], high[0], low[1], high[1]),)), []
    for first in range(0, len(found), AT_ONCE):
        batch = slice(first, first + AT_ONCE)
        problems = [_moment_scenario(world, moment, f"rollout/{first + i}") for i, moment in enumerate(found[batch])]
        lead = _make_lead(recording, found[batch], only[batch])
        positions = simulate_walks(model, problems, PREDICTED * INTERVAL, 1.0 / INTERVAL, lead)[1:]
        guesses += [positions[:, k, : len(moment.walks)].transpose(1, 0, 2) for k, moment in enumerate(found[batch])]
    return guesses


def _moment_scenario(world: World, moment: Moment, name: str) -> Scenario:
    """Return the people of a moment, each on the way to where the recording last has it."""
    people = [
        PedestrianSpec(k, moment.positions[k], moment.goals[k : k + 1], float(moment.speeds[k]), RADIUS)
        for k in range(len(moment.walks))
    ]
    return make_scenario(world, people, PREDICTED * INTERVAL, name)


def _make_lead(recording: Recording, found: list[Moment], only: list[Any]) -> Lead:
    """Return what sets everybody's velocity at the start and, where ``only`` names one, puts the others where they were
    recorded.

    Who is recorded no longer walks on.
    """
    rows = [
        (i, k)
        for i, moment in enumerate(found)
        for k in range(len(moment.walks))
        if only[i] is not None and only[i] != k
    ]
    worlds, places = np.array(rows, np.int64).reshape(-1, 2).T
    walks = np.array([found[i].walks[k] for i, k in rows], np.int64)
    begins = np.array([found[i].time for i, _ in rows])

    def lead(crowd: Crowd, time: float) -> Crowd:
        positions, velocities = crowd.positions.copy(), crowd.velocities.copy()
        if time == 0.0:
            for i, moment in enumerate(found):
                velocities[i, : len(moment.walks)] = moment.velocities
        there, speeds = recording.at(walks, begins + time)
        gone = ~np.isfinite(there).all(axis=1)
        there[gone] = positions[worlds, places][gone]
        speeds[gone] = velocities[worlds, places][gone]
        positions[worlds, places], velocities[worlds, places] = there, speeds
        return replace(crowd, positions=positions, velocities=velocities)

    return lead


def _error_row(name: str, errors: Floats) -> dict[str, Any]:
    """Return average and final displacement error, m, and the share of walks that end within half a metre."""
    final = errors[:, -1]
    return {
        "who": name,
        "walks": len(errors),
        "ade_m": float(errors.mean()),
        "fde_m": float(final.mean()),
        "within_half_a_metre": float((final < 0.5).mean()),
    }


def _draw_figure(figure: Any, errors: Mapping[str, Floats]) -> None:
    axes = figure.subplots()
    for name, own in errors.items():
        style = "k-" if name == "constant velocity" else "k--" if name == "straight to the goal" else "o-"
        axes.plot(INTERVAL * np.arange(1, PREDICTED + 1), own.mean(axis=0), style, markersize=3, label=name)
    axes.set(
        xlabel="time ahead [s]",
        ylabel="mean distance from the recorded position [m]",
        xlim=(0.0, None),
        ylim=(0.0, None),
    )
    axes.legend(fontsize="small")
