"""Records of Arena-Bench's own recorder (arena-evaluation, 01_recording): CSV files with a row for each 0.4 s or so."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, InputFileError, Pose, Robot
from arena_core.commands import one_line
from arena_ros.bags.records import (
    ALL_PEOPLE,
    Arrays,
    EpisodeIdentity,
    Reading,
    empty_contacts,
    episode_ending,
    episode_identity,
)

ENDING = ".csv"
PERIOD = 0.4  # s between two rows, as the recorder was configured
FIGURES = (
    "time",
    "laser_scan",
    "robot_lin_vel_x",
    "robot_lin_vel_y",
    "robot_ang_vel",
    "robot_orientation",
    "robot_pos_x",
    "robot_pos_y",
)
COLUMNS = ("episode", *FIGURES, "action")
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*(?:e[-+]?\d+)?|inf|nan)", re.IGNORECASE)
LONGEST = 100_000  # rows of one episode: eleven hours


@dataclass(frozen=True, slots=True, eq=False)
class LegacyEpisode:
    """The rows of one episode: the figures in the order of the file's columns, (T,
    8), and what was commanded, (T, 3).
    """

    number: str
    figures: NDArray[np.float64]
    actions: NDArray[np.float64]


class LegacyFile:
    """One file; ``left_out`` counts rows that could not be read, or whose time does not go on."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.left_out = 0

    def episodes(self) -> Iterator[LegacyEpisode]:
        """Yield the episodes one after the other; raise InputFileError where the file is none of the recorder's."""
        try:
            with self.path.open(newline="", encoding="utf-8", errors="replace") as file:
                reader = csv.DictReader(file)
                missing = sorted(set(COLUMNS) - set(reader.fieldnames or ()))
                if missing:
                    raise InputFileError(
                        f"{self.path}: has no column {missing[0]}; allowed: files of Arena-Bench's data recorder"
                    )
                for number, rows in groupby(reader, key=lambda row: row["episode"]):
                    if (episode := self._make_episode(number, rows)) is not None:
                        yield episode
        except csv.Error as error:
            raise InputFileError(
                f"{self.path}: is no CSV ({one_line(str(error), 80)}); allowed: files of the recorder"
            ) from None

    def _make_episode(self, number: str, rows: Iterator[Mapping[str, Any]]) -> LegacyEpisode | None:
        figures, actions = list[list[float]](), list[list[float]]()
        for row in rows:
            read = _parse_row(row)
            if read is None or (figures and read[0][0] <= figures[-1][0]) or len(figures) == LONGEST:
                self.left_out += 1
                continue
            figures.append(read[0])
            actions.append(read[1])
        return LegacyEpisode(number, np.array(figures), np.array(actions)) if len(figures) > 1 else None


def _parse_row(row: Mapping[str, Any]) -> tuple[list[float], list[float]] | None:
    """Return figures and action of a row;

    None where they are no numbers. The scan is a list of one, its nearest range.
    """
    scan, action = NUMBER.findall(row["laser_scan"] or ""), NUMBER.findall(row["action"] or "")
    try:
        figures = [float(row[name]) for name in FIGURES if name != "laser_scan"]
        figures.insert(1, min(map(float, scan)))
    except (TypeError, ValueError):
        return None
    command = [float(each) for each in action]
    others = [*figures[:1], *figures[2:], *command]
    return (figures, command) if len(command) == 3 and np.isfinite(others).all() else None


def legacy_record(
    episode: LegacyEpisode, goal: Pose | None, robot: Robot, reading: Reading, identity: EpisodeIdentity
) -> EpisodeRecord:
    """Return an episode as a record, row for row; the final state is the last row once more, a period later.

    ``meta["unknown"]`` names the arrays that the recorder did not write, with the reason.
    """
    since = episode.figures[:, 0] - episode.figures[0, 0]
    rows = episode.figures[:, [6, 7, 5]]
    last, outcome, error = episode_ending(goal, rows, since, reading, "the rows end")
    arrays = _record_arrays(episode.figures[: last + 1], episode.actions[: last + 1])
    unknown = {"estimate": "without a reference pose the truth is itself an estimate"}
    unknown["clearance"] = "of each scan only the nearest range was recorded"
    if "people" not in reading.without:
        unknown |= dict.fromkeys(ALL_PEOPLE, "the recorder did not write where people were")
    arrays |= empty_contacts(len(arrays["stamp"]), reading, unknown)
    end = goal.array().tolist() if goal is not None else rows[-1].tolist()
    facts = {"outcome": outcome, "error": error, "truth": "odometry", "unknown": unknown}
    return EpisodeRecord(arrays, {**episode_identity(arrays, robot, reading, identity, end), **facts})


def _record_arrays(figures: NDArray[np.float64], actions: NDArray[np.float64]) -> Arrays:
    held, nothing = np.concatenate((figures, figures[-1:])), np.full((1, 3), np.nan)
    rows = len(held)
    stamps = np.append(figures[:, 0], figures[-1, 0] + PERIOD) - figures[0, 0]
    return {
        "stamp": np.round(stamps, 9),
        "pose": held[:, [6, 7, 5]],
        "twist": held[:, 2:5],
        "estimate": np.full((rows, 3), np.nan),
        "estimate_covariance": np.full((rows, 3, 3), np.nan, np.float32),
        "command": np.concatenate((actions, nothing)),
        "waypoint": np.full((rows, 3), np.nan),
        "scan_min": np.append(figures[:, 1], np.nan),
        "clearance": np.full(rows, np.nan),
        "clearance_people": np.full(rows, np.inf),
        "pedestrian_ids": np.empty(0, np.int32),
        "pedestrian_radii": np.empty(0),
        "pedestrian_positions": np.empty((rows, 0, 2), np.float32),
        "pedestrian_velocities": np.empty((rows, 0, 2), np.float32),
        "pedestrian_states": np.empty((rows, 0), np.int8),
        "path_poses": np.empty((0, 3)),
        "path_offsets": np.zeros(1, np.int64),
        "path_stamps": np.empty(0),
    }
