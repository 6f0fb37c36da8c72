"""What a record must hold to be one: its arrays with their extents, and what identifies it (docs/records.md)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import PurePosixPath
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from arena_core.base.limits import LIMITS
from arena_core.values.episode import Outcome

Extents = tuple[str | int, ...]
REAL, WHOLE, TRUTH = "fiu", "iu", "b"

# by name: the extents, equal letters being equal numbers, and the kind of the elements; T rows, P people, C contacts, K
# paths.
LAYOUT: Mapping[str, tuple[Extents, str]] = {
    **{name: (("T",), REAL) for name in ("stamp", "clearance", "clearance_people", "contact_time", "scan_min")},
    **{name: (("T", 3), REAL) for name in ("pose", "twist", "estimate", "command", "waypoint")},
    "estimate_covariance": (("T", 3, 3), REAL),
    "in_contact": (("T",), TRUTH),
    "pedestrian_ids": (("P",), WHOLE),
    "pedestrian_radii": (("P",), REAL),
    "pedestrian_positions": (("T", "P", 2), REAL),
    "pedestrian_velocities": (("T", "P", 2), REAL),
    "pedestrian_states": (("T", "P"), WHOLE),
    **{name: (("C",), REAL) for name in ("contact_stamp", "contact_speed")},
    "contact_kind": (("C",), WHOLE),
    "contact_person": (("C",), WHOLE),
    "contact_caused": (("C",), TRUTH),
    "contact_position": (("C", 2), REAL),
    "path_poses": (("M", 3), REAL),
    "path_offsets": (("O",), WHOLE),
    "path_stamps": (("K",), REAL),
}

# only where a run kept them (arena_core.loop.extras), or since records hold them; each with what its offsets count
EXTRAS: Mapping[str, tuple[Extents, str]] = {
    "route_points": (("W", 2), REAL),
    "route_offsets": (("B",), WHOLE),  # one more than people
    "considered_rows": (("R",), WHOLE),
    "considered_offsets": (("O",), WHOLE),
    "considered_points": (("M", 2), REAL),
    "considered_costs": (("N",), REAL),
    "considered_chosen": (("N",), TRUTH),
    "track_rows": (("R",), WHOLE),
    "track_ids": (("K",), WHOLE),
    "track_positions": (("K", 2), REAL),
    "track_velocities": (("K", 2), REAL),
    "track_radii": (("K",), REAL),
    "doors_open": (("T", "D"), TRUTH),  # of scenarios with doors
    "team_stamp": (("S",), REAL),
    "team_pose": (("S", "A", 3), REAL),
}
OFFSETS = {
    "route": (("route_offsets", "route_points"),),
    "considered": (("considered_rows", "considered_costs"), ("considered_offsets", "considered_points")),
    "track": (("track_rows", "track_ids"),),
    "team": (),
}


def fault_of(arrays: Mapping[str, NDArray[Any]], meta: Any) -> str:
    """Return what is wrong with a record, in a few words; empty where nothing is."""
    if not isinstance(meta, Mapping):
        return "meta is no mapping"
    parts = (_fault_of_arrays, fault_of_numbers, _fault_of_paths, _fault_of_extras)
    fault = next((fault for part in parts if (fault := part(arrays))), "") or _fault_of_meta(meta)
    return fault or _fault_of_doors(arrays, meta["scenario"])


def fault_of_numbers(arrays: Mapping[str, NDArray[Any]]) -> str:
    """Return which numbers of a record lie so far off that what is computed of them has no
    bounds; empty where none does.
    """
    stamps, places = arrays["stamp"].astype(np.float64), arrays["pose"].astype(np.float64)
    if not np.isfinite(stamps).all() or (np.diff(stamps) < 0.0).any():
        return "stamp is not finite and rising"
    if stamps[-1] - stamps[0] > LIMITS.record_seconds or abs(stamps[0]) > LIMITS.record_farthest:
        return f"stamp goes from {stamps[0]:g} to {stamps[-1]:g} s; up to {LIMITS.record_seconds:g} s are read"
    if not np.isfinite(places).all():
        return "pose is not finite"
    for name in ("pose", "pedestrian_positions", "path_poses", "contact_position", "contact_stamp", "path_stamps"):
        if name in arrays and (np.abs(arrays[name]) > LIMITS.record_farthest).any():
            return f"{name} goes beyond {LIMITS.record_farthest:g}"
    driven = float(np.hypot(*np.diff(places[:, :2], axis=0).T).sum())
    return (
        f"pose covers {driven:g} m; up to {LIMITS.record_metres:g} m are read" if driven > LIMITS.record_metres else ""
    )


def fault_of_timing(arrays: Mapping[str, NDArray[Any]]) -> str:
    """Return which array of an episode's wall-clock times is none; empty where all are."""
    return next(
        (
            f"{name} is {array.dtype} {array.shape}"
            for name, array in arrays.items()
            if array.ndim != 1 or array.dtype.kind != "f"
        ),
        "",
    )


def is_inside(name: object) -> bool:
    """Return whether a name is that of a file below the folder of its record, by its words."""
    path = (
        PurePosixPath(name) if isinstance(name, str) and "\0" not in name and "\\" not in name else PurePosixPath("/")
    )
    return bool(path.parts) and not path.is_absolute() and ".." not in path.parts


def _fault_of_arrays(arrays: Mapping[str, NDArray[Any]]) -> str:
    extents: dict[str | int, int] = {}
    return _find_mismatch(arrays, LAYOUT, extents) or ("" if extents["T"] > 0 else "it has no rows")


def _find_mismatch(
    arrays: Mapping[str, NDArray[Any]], layout: Mapping[str, tuple[Extents, str]], extents: dict[str | int, int]
) -> str:
    """Return which array is missing or has not the extents of its layout; ``extents`` are known
    ones, and take in what is found.
    """
    for name, (letters, kinds) in layout.items():
        if name not in arrays:
            return f"it lacks {name}"
        array = arrays[name]
        fits = array.ndim == len(letters) and array.dtype.kind in kinds
        if not fits or any(
            extents.setdefault(x, x if isinstance(x, int) else n) != n
            for x, n in zip(letters, array.shape, strict=True)
        ):
            return f"{name} is {array.dtype} {array.shape}"
    return ""


def _fault_of_paths(arrays: Mapping[str, NDArray[Any]]) -> str:
    offsets = arrays["path_offsets"]
    whole = (
        len(offsets) == len(arrays["path_stamps"]) + 1 and offsets[0] == 0 and offsets[-1] == len(arrays["path_poses"])
    )
    if not whole or (np.diff(offsets.astype(np.int64)) < 0).any():
        return "path_offsets are not those of path_poses"
    return "" if np.isin(arrays["contact_kind"], (0, 1, 2, 3)).all() else "contact_kind is unknown"


def _fault_of_extras(arrays: Mapping[str, NDArray[Any]]) -> str:
    """Return what is wrong with arrays that a record need not have."""
    for prefix, offsets in OFFSETS.items():
        layout = {name: said for name, said in EXTRAS.items() if name.startswith(f"{prefix}_")}
        if not any(name in arrays for name in layout):
            continue
        if fault := _find_mismatch(arrays, layout, {"R": len(arrays["stamp"]), "B": len(arrays["pedestrian_ids"]) + 1}):
            return fault
        places = [
            name for name in layout if name.endswith(("_points", "_positions", "_velocities", "_radii", "team_pose"))
        ]
        if far := next((name for name in places if not (np.abs(arrays[name]) <= LIMITS.record_farthest).all()), ""):
            return f"{far} is not finite, or goes beyond {LIMITS.record_farthest:g}"
        for name, of in offsets:
            steps = arrays[name].astype(np.int64)
            if len(steps) == 0 or steps[0] != 0 or steps[-1] != len(arrays[of]) or (np.diff(steps) < 0).any():
                return f"{name} are no offsets of {of}"
    scans = arrays.get("scan_ranges")
    if scans is not None and (scans.ndim != 2 or scans.dtype.kind != "f" or len(scans) != len(arrays["stamp"]) - 1):
        return f"scan_ranges is {scans.dtype} {scans.shape}"
    if "considered_costs" in arrays and len(arrays["considered_offsets"]) != len(arrays["considered_costs"]) + 1:
        return "considered_offsets are not those of considered_costs"
    return ""


def _fault_of_meta(meta: Mapping[str, Any]) -> str:
    lacking = [
        key for key in ("columns", "scenario", "robot", "world", "config") if not isinstance(meta.get(key), Mapping)
    ]
    if lacking:
        return f"meta has no {lacking[0]}"
    if meta.get("outcome") not in get_args(Outcome) or not isinstance(meta.get("error"), str):
        return "meta has no outcome and error"
    if not all(isinstance(value, str | int | float | None) for value in meta["columns"].values()):
        return "meta.columns has more than texts and numbers"
    if not isinstance(meta.get("events"), list) or not all(_is_event(event) for event in meta["events"]):
        return "meta.events are none"
    if "grid" in meta["world"] and not is_inside(meta["world"]["grid"]):
        return "meta.world.grid lies outside the run's folder"
    return _fault_of_scenario(meta["scenario"]) or _fault_of_robot(meta["robot"]) or _fault_of_team(meta.get("team"))


def _fault_of_team(team: object) -> str:
    """Return what is wrong with what a record says of its team; there need be none."""
    if team is None:
        return ""
    robots = team.get("robots") if isinstance(team, Mapping) else None
    if not isinstance(robots, list) or not all(_is_team_robot(robot) for robot in robots):
        return "meta.team has no robots"
    if fault := _fault_of_errands(team.get("errands") if isinstance(team, Mapping) else None, len(robots)):
        return fault
    member = team["member"] if isinstance(team, Mapping) and isinstance(team.get("member"), int) else -1
    return "" if 0 <= member < len(robots) else "meta.team.member is none of its robots"


def _fault_of_errands(errands: object, robots: int) -> str:
    """Return what is wrong with what a record says of a team's errands; there need be none."""
    if errands is None:
        return ""
    if not isinstance(errands, Mapping) or not isinstance(errands.get("kind"), str):
        return "meta.team.errands has no kind"
    places, visits = errands.get("places"), errands.get("visits")
    if not isinstance(places, list) or not all(_is_row(place, 2) for place in places):
        return "meta.team.errands.places are none"
    if not isinstance(visits, list) or not all(_is_visit(visit, robots, len(places)) for visit in visits):
        return "meta.team.errands.visits are none"
    return ""


def _is_visit(visit: Any, robots: int, places: int) -> bool:
    return _is_row(visit, 3) and visit[1] in range(robots) and visit[2] in range(places)


def _is_team_robot(robot: object) -> bool:
    if not isinstance(robot, Mapping) or not all(isinstance(robot.get(key), str) for key in ("name", "planner")):
        return False
    ended = robot.get("outcome") in get_args(Outcome) and _is_number(robot.get("end"))
    return ended and all(_is_row(robot.get(key), 3) for key in ("start", "goal"))


def _fault_of_scenario(scenario: Mapping[str, Any]) -> str:
    for key in ("start", "goal"):
        if not _is_row(scenario.get(key), 3):
            return f"meta.scenario.{key} is no pose"
    if not all(_is_number(scenario.get(key)) for key in ("goal_radius", "time_limit")):
        return "meta.scenario has no goal_radius and time_limit"
    obstacles = scenario.get("obstacles")
    if not isinstance(obstacles, list) or not all(_is_obstacle(obstacle) for obstacle in obstacles):
        return "meta.scenario.obstacles are none"
    furniture = scenario.get("furniture", [])
    if not isinstance(furniture, list) or not all(_is_furniture(piece) for piece in furniture):
        return "meta.scenario.furniture is none"
    optional = [scenario.get(key) for key in ("reference_length", "speed_share")]
    return (
        ""
        if all(value is None or _is_number(value) for value in optional)
        else "meta.scenario.reference_length is no number"
    )


def _fault_of_doors(arrays: Mapping[str, NDArray[Any]], scenario: Mapping[str, Any]) -> str:
    """Return what is wrong with doors, which most records have not."""
    doors = scenario.get("doors", [])
    if not isinstance(doors, list) or not all(_is_door(door) for door in doors):
        return "meta.scenario.doors are none"
    states = arrays.get("doors_open", np.zeros((len(arrays["stamp"]), 0), np.bool_))
    if states.dtype.kind != TRUTH or states.shape != (len(arrays["stamp"]), len(doors)):
        return f"doors_open is {states.dtype} {states.shape}"
    return ""


def _fault_of_robot(robot: Mapping[str, Any]) -> str:
    footprint, limits = robot.get("footprint"), robot.get("limits", {})
    if (
        not isinstance(footprint, Mapping)
        or not _is_number(footprint.get("radius"))
        or not isinstance(footprint.get("vertices_xy"), list)
    ):
        return "meta.robot has no footprint"
    if not all(_is_row(vertex, 2) for vertex in footprint["vertices_xy"]):
        return "meta.robot.footprint has no vertices_xy"
    if not isinstance(limits, Mapping) or not all(_is_number(value) for value in limits.values()):
        return "meta.robot.limits are none"
    return "" if _is_number(robot.get("control_period", 0.0)) else "meta.robot.control_period is no number"


def _is_event(event: object) -> bool:
    return (
        isinstance(event, Mapping)
        and _is_number(event.get("stamp"))
        and all(isinstance(event.get(k), str) for k in ("kind", "detail"))
    )


def _is_obstacle(obstacle: object) -> bool:
    if not isinstance(obstacle, Mapping):
        return False
    vertices = obstacle.get("vertices_xy")
    is_outline = isinstance(vertices, list) and bool(vertices) and all(_is_row(v, 2) for v in vertices)
    return is_outline and _is_number(obstacle.get("radius"))


def _is_door(door: object) -> bool:
    if not isinstance(door, Mapping) or not _is_obstacle({**door, "radius": 0.0}):
        return False
    intervals = door.get("open")
    if not isinstance(intervals, list) or not all(isinstance(pair, list) and len(pair) == 2 for pair in intervals):
        return False
    times = [door.get("period"), *(time for pair in intervals for time in pair)]
    return all(time is None or _is_number(time) for time in times)


def _is_furniture(piece: object) -> bool:
    if not isinstance(piece, Mapping) or not isinstance(piece.get("kind"), str) or not _is_row(piece.get("pose"), 3):
        return False
    solids = [(piece.get(shape), width) for shape, width in (("boxes", 7), ("cylinders", 5))]
    return all(isinstance(rows, list) and all(_is_row(row, width) for row in rows) for rows, width in solids)


def _is_row(value: object, length: int) -> bool:
    return isinstance(value, list) and len(value) == length and all(map(_is_number, value))


def _is_number(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(float(value)) and abs(value) <= LIMITS.record_farthest
    except OverflowError:
        return False
