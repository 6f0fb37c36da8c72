"""Drives of the suite's own simulator, watched: what a tracker told at every step, and where people truly were."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    EpisodeStart,
    InputFileError,
    Observation,
    OccupancyGrid,
    Planner,
    Pose,
    Predictions,
    Predictor,
    Tracks,
    Twist,
)
from arena_core.commands import one_line
from arena_core.files import read_arrays, write_bytes_whole
from arena_core.hosting import Benchmark, build_benchmark, check_predictions, compose, load_registry

Floats = NDArray[np.float64]
ALLOWED = "a drive that `arena predict train` wrote"


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """One episode: ``stamps`` (T,) s with the ``tracks`` (T) of each, the map, and ``people`` (T, P, 2) m with their
    ``velocities`` (T, P, 2) m/s and ``radii`` (P,) m, NaN where they are absent.
    """

    stamps: Floats
    tracks: Sequence[Tracks]
    grid: OccupancyGrid | None
    people: Floats
    velocities: Floats
    radii: Floats


@dataclass(slots=True, eq=False)
class WatchingPlanner(Planner):
    """Notes the tracks of every step, asks predictors, then does what another planner does."""

    planner: Planner
    predictors: Mapping[str, Predictor] = field(default_factory=dict)
    stamps: list[float] = field(default_factory=list)
    tracks: list[Tracks] = field(default_factory=list)
    said: list[dict[str, Predictions]] = field(default_factory=list)
    spent: dict[str, list[float]] = field(default_factory=dict)
    grid: OccupancyGrid | None = None

    def reset(self, episode: EpisodeStart) -> None:
        """Begin a new page."""
        self.stamps, self.tracks, self.said, self.grid = [], [], [], episode.map
        for predictor in self.predictors.values():
            predictor.reset(episode.map)
        self.planner.reset(episode)

    def compute_velocity(self, observation: Observation) -> Twist:
        """Note what is seen, and what each predictor says of it."""
        self.stamps.append(observation.stamp)
        self.tracks.append(observation.tracks)  # what the tracker takes is not a predictor's
        told = {}
        for name, predictor in self.predictors.items():
            began = process_time()
            said = predictor.predict(observation)
            self.spent.setdefault(name, []).append(process_time() - began)
            told[name] = check_predictions(said, predictor, observation.tracks)
        self.said.append(told)
        return self.planner.compute_velocity(observation)


def watched_benchmark(words: Sequence[str]) -> tuple[Benchmark, WatchingPlanner]:
    """Return what ``arena run WORDS`` would run, with a planner that watches."""
    benchmark = build_benchmark(compose(list(words)), load_registry())
    watching = WatchingPlanner(benchmark.navigator.planner)
    benchmark.navigator.planner = watching
    return benchmark, watching


def drive(benchmark: Benchmark, watching: WatchingPlanner, episode: int) -> Drive:
    """Run one episode."""
    with tempfile.TemporaryDirectory() as folder:
        record = benchmark.run(episode, Path(folder))
    stamps = np.array(watching.stamps)
    rows = np.searchsorted(record["stamp"], stamps - 1e-6)
    return Drive(
        stamps,
        tuple(watching.tracks),
        watching.grid,
        record["pedestrian_positions"].astype(np.float64)[rows],
        record["pedestrian_velocities"].astype(np.float64)[rows],
        record["pedestrian_radii"].astype(np.float64),
    )


def true_tracks(driven: Drive) -> tuple[Tracks, ...]:
    """Return the people of each step as tracks that err in nothing."""
    found = []
    for positions, velocities in zip(driven.people, driven.velocities, strict=True):
        there = np.flatnonzero(np.isfinite(positions).all(axis=1))
        nothing = np.zeros((len(there), 4, 4))
        found.append(Tracks(there.astype(np.int32), positions[there], velocities[there], driven.radii[there], nothing))
    return tuple(found)


def save_drive(path: Path, driven: Drive) -> None:
    """Write a drive, whole or not at all."""
    counts = np.array([len(each.ids) for each in driven.tracks])
    packed = {
        name: np.concatenate([np.empty((0, *shape), kind), *(getattr(each, name) for each in driven.tracks)])
        for name, shape, kind in (
            ("ids", (), np.int32),
            ("positions", (2,), np.float64),
            ("velocities", (2,), np.float64),
            ("radii", (), np.float64),
            ("covariances", (4, 4), np.float64),
        )
    }
    packed["covariances"] = packed["covariances"].astype(np.float32)
    grid = driven.grid
    where = np.empty(0) if grid is None else np.array((grid.resolution, *grid.origin.array()))
    shape = np.empty(0, np.int64) if grid is None else np.array(grid.occupied.shape)
    cells = np.empty(0, np.uint8) if grid is None else np.packbits(grid.occupied)
    file = io.BytesIO()
    arrays: dict[str, Any] = {
        **packed,
        "stamps": driven.stamps,
        "counts": counts,
        "people": driven.people.astype(np.float32),
        "people_velocities": driven.velocities.astype(np.float32),
        "people_radii": driven.radii,
        "where": where,
        "shape": shape,
        "cells": cells,
    }
    np.savez_compressed(file, **arrays)
    write_bytes_whole(path, file.getvalue())


def load_drive(path: Path) -> Drive:
    """Read a drive; raise InputFileError where the file is none."""
    content = read_arrays(path, ALLOWED)
    try:
        ends = np.cumsum(content["counts"])
        parts = [slice(int(end - count), int(end)) for end, count in zip(ends, content["counts"], strict=True)]
        names = ("ids", "positions", "velocities", "radii", "covariances")
        content["covariances"] = content["covariances"].astype(np.float64)
        tracks = tuple(Tracks(*(content[name][part] for name in names)) for part in parts)
        grid = _grid_of(content) if len(content["where"]) else None
        return Drive(
            content["stamps"],
            tracks,
            grid,
            content["people"].astype(np.float64),
            content["people_velocities"].astype(np.float64),
            content["people_radii"],
        )
    except (KeyError, ValueError, IndexError, TypeError) as error:
        raise InputFileError(f"{path}: is no drive ({one_line(repr(error))}); allowed: {ALLOWED}") from None


def _grid_of(content: Mapping[str, NDArray[np.generic]]) -> OccupancyGrid:
    resolution, *origin = content["where"].tolist()
    rows, columns = content["shape"].tolist()
    occupied = np.unpackbits(content["cells"].astype(np.uint8), count=rows * columns).reshape(rows, columns)
    return OccupancyGrid((100 * occupied.astype(np.int16)).astype(np.int8), resolution, Pose(*origin))
