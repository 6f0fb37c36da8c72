"""The pack social on records whose figures can be worked out by hand."""

import math

import numpy as np
import pytest

from arena_core import ConfigurationError, EpisodeRecord
from arena_core.hosting import load_registry
from arena_core.records import build_metrics, evaluate_record
from arena_metrics.packs.progress import along_path
from arena_metrics.packs.social import SocialMetrics
from arena_metrics.packs.social_forces import social_force

RADIUS, BODY = 0.2, 0.3  # m, of the robot and of people in these records
MIRRORED = {"passes_left": "passes_right", "passes_right": "passes_left"}


def among(record_of, poses, people, dt=0.1, **arrays):
    """Return a record with people at (T, P, 2), whose velocities and clearances follow from that."""
    poses, people = np.asarray(poses, float), np.asarray(people, float)
    velocities = np.nan_to_num(np.diff(people, axis=0) / dt)
    gaps = np.linalg.norm(people - poses[:, None, :2], axis=2) - RADIUS - BODY
    nearest = np.where(np.isnan(gaps), np.inf, np.maximum(gaps, 0.0)).min(axis=1, initial=np.inf)
    given = {
        "pedestrian_positions": people,
        "pedestrian_velocities": np.concatenate((velocities, velocities[-1:])),
        "clearance_people": nearest,
    }
    return record_of(poses, dt, **{**given, **arrays})


def standing(place, rows):
    return np.tile(np.asarray(place, float), (rows, 1, 1))


@pytest.fixture
def passed(record_of, straight_line):
    """Give the record of a drive of 8 m at 0.5 m/s past one who stands 0.8 m from its outline, to the left."""
    poses = straight_line(length=8.0)
    return among(record_of, poses, standing([(4.0, 0.8 + RADIUS + BODY)], len(poses)))


def test_a_person_passed_at_80_cm(social, passed):
    side, reach = 0.8 + RADIUS + BODY, 1.2 + RADIUS + BODY
    near = 2.0 * math.sqrt(reach**2 - side**2) / 0.5  # s within 1.2 m of each other
    assert social["personal_share"](passed) == pytest.approx(near / 16.0, abs=0.01)
    assert social["intimate_share"](passed) == 0.0
    assert social["space_compliance"](passed) == 1.0
    assert social["near_misses"](passed) == 0.0
    x = np.linspace(-0.5 * near * 0.5, 0.5 * near * 0.5, 20001)
    depth = np.trapezoid(reach - np.hypot(x, side), x / 0.5)
    assert social["proxemic_intrusion"](passed) == pytest.approx(depth, rel=0.01)
    assert (social["passes_left"](passed), social["passes_right"](passed)) == (1.0, 0.0)
    assert social["min_predicted_distance"](passed) == pytest.approx(0.8, abs=1e-3)
    assert social["future_intrusion"](passed) == 0.0
    wound = 2.0 * math.atan(4.0 / side) / (2.0 * math.pi)
    assert social["topological_complexity"](passed) == pytest.approx(wound, rel=1e-3)
    assert math.isnan(social["yield_score"](passed))  # no course, nothing to yield


def test_standing_people_have_round_spaces_and_walking_ones_long_ones(social, record_of, straight_line):
    poses = straight_line(length=2.0)
    still = among(record_of, poses, standing([(1.0, 0.5)], len(poses)))
    assert social["personal_space_cost_max"](still) == pytest.approx(
        math.exp(-0.5 * (0.5 / (1.0 / 3.0)) ** 2), abs=1e-3
    )
    waiting = np.tile((0.0, 0.0, 0.0), (11, 1))
    oncoming = 1.5 - np.arange(11)[:, None, None] * 0.1 * np.array((1.0, 0.0)) + np.zeros((11, 1, 2))
    oncoming[..., 1] = 0.0
    front = among(record_of, waiting, oncoming)
    assert social["personal_space_cost_max"](front) == pytest.approx(math.exp(-0.5 * (0.5 / 2.0) ** 2), abs=1e-3)
    behind = among(record_of, waiting, oncoming[::-1])
    assert social["personal_space_cost_max"](behind) == pytest.approx(math.exp(-0.5 * 0.5**2), abs=1e-3)


def test_a_robot_in_a_group(social, record_of, straight_line):
    """Four stand on a square of 2 m, which the robot crosses at 0.5 m/s: 4 s among them."""
    poses = straight_line(length=6.0)
    square = standing([(2.0, -0.5), (4.0, -0.5), (4.0, 0.5), (2.0, 0.5)], len(poses))
    record = among(record_of, poses, square)
    assert social["group_intrusion"](record) == pytest.approx(4.0, abs=0.15)
    inner = math.hypot(1.0, 0.5) - BODY  # of the circle that the bodies leave free
    assert social["group_intimate_share"](record) == pytest.approx(2.0 * (inner + RADIUS + 0.45) / 6.0, abs=0.02)
    beside = among(record_of, poses + np.array((0.0, 0.6, 0.0)), square)
    assert social["group_intrusion"](beside) == 0.0


def test_one_alone_or_those_who_walk_apart_are_no_group(social, record_of, straight_line):
    poses = straight_line(length=6.0)
    alone = among(record_of, poses, standing([(2.0, 1.0), (5.0, 1.0)], len(poses)))
    crossing = standing([(2.0, 1.0), (2.0, 2.0)], len(poses))
    crossing[:, 1, 0] += np.linspace(0.0, 8.0, len(poses))
    for record in (alone, among(record_of, poses, crossing)):
        assert social["group_intrusion"](record) == 0.0
        assert math.isnan(social["group_personal_share"](record))


def test_a_pair_has_an_inner_space_but_no_inside(social, record_of, straight_line):
    poses = straight_line(length=6.0)
    record = among(record_of, poses, standing([(3.0, 0.6), (3.0, -0.6)], len(poses)))
    assert social["group_intrusion"](record) == 0.0
    assert social["group_intimate_share"](record) > 0.0


def test_intrusions_are_charged_to_who_came_nearer(social, record_of, straight_line):
    poses = straight_line(length=4.0)
    by_robot = among(record_of, poses, standing([(4.0, 0.2)], len(poses)))
    assert [social[f"intrusions_by_{who}"](by_robot) for who in ("robot", "person")] == [1.0, 0.0]
    waiting = np.zeros((41, 3))
    walker = np.stack((np.linspace(4.0, 0.6, 41), np.full(41, 0.1)), axis=1)[:, None]
    by_person = among(record_of, waiting, walker)
    assert [social[f"intrusions_by_{who}"](by_person) for who in ("robot", "person")] == [0.0, 1.0]
    assert social["near_misses"](by_person) == 1.0


def test_who_turns_away_from_a_collision_course_yields(social, record_of, straight_line):
    poses = straight_line(length=6.0)
    poses[60:, 1] = np.minimum(np.arange(len(poses) - 60) * 0.05, 1.0)
    walker = np.stack((9.0 - 0.05 * np.arange(len(poses)), np.zeros(len(poses))), axis=1)[:, None]
    assert social["yield_score"](among(record_of, poses, walker)) == pytest.approx(1.0)
    aside = walker.copy()
    aside[60:, 0, 1] = np.minimum(np.arange(len(poses) - 60) * 0.05, 1.0)
    assert social["yield_score"](among(record_of, straight_line(length=6.0), aside)) == pytest.approx(0.0, abs=1e-9)


def test_the_future_place_of_a_person_is_intruded_before_it_comes(social, record_of):
    """A person of 1 m/s walks through a standing robot: from 1.25 s before it touches until it has gone."""
    rows = 81
    walker = np.stack((np.linspace(-4.0, 4.0, rows), np.zeros(rows)), axis=1)[:, None]
    record = among(record_of, np.zeros((rows, 3)), walker)
    assert social["future_intrusion"](record) == pytest.approx((2.0 * (RADIUS + BODY) + 1.25) / 8.0, abs=0.03)


def test_a_robot_that_oscillates_reverses(social, record_of):
    x = np.concatenate([np.linspace(0, 1, 11)[:-1], np.linspace(1, 0, 11)[:-1]] * 3 + [[0.0]])
    poses = np.stack((x, 0 * x, 0 * x), axis=1)
    record = record_of(poses, 0.1)
    assert social["reversals"](record) == pytest.approx(5.0 * 60.0 / 6.0)
    assert social["heading_change"](record) == 0.0


def test_motion_on_a_line_and_on_a_circle(social, record_of, straight_line, round_trip):
    line, circle = record_of(straight_line()), record_of(round_trip())
    assert [social[f"speed_{end}"](line) for end in ("min", "max")] == pytest.approx([0.5, 0.5])
    assert social["acceleration_max"](line) == pytest.approx(0.0, abs=1e-9)
    assert social["acceleration_max"](circle) == pytest.approx(0.5**2 / 2.0, rel=0.01)
    assert social["jerk_min"](circle) == pytest.approx(0.5**3 / 2.0**2, rel=0.02)
    assert social["heading_change"](circle) == pytest.approx(2.0 * math.pi, rel=0.01)
    assert social["yaw_rate_mean"](record_of(round_trip(turns=0.2))) == pytest.approx(0.25, rel=0.01)
    assert social["motion_energy"](line) == pytest.approx(0.25 * 8.0)
    assert social["path_efficiency"](line) == pytest.approx(1.0)
    assert social["path_irregularity"](line) == 0.0
    assert social["path_irregularity"](circle) == pytest.approx(0.5, rel=0.02)  # 1 / radius: all of it is needless


def test_turns_of_the_first_path_are_needed(social, record_of):
    corner = np.array(
        [(x, 0.0, 0.0) for x in np.linspace(0, 2, 41)] + [(2.0, y, 1.57) for y in np.linspace(0.05, 2, 40)]
    )
    path = {"path_poses": corner, "path_offsets": [0, len(corner)], "path_stamps": [0.0]}
    assert social["path_irregularity"](record_of(corner, **path)) == 0.0
    assert social["path_irregularity"](record_of(corner)) == pytest.approx(0.5 * math.pi / 4.0, rel=0.05)


def test_windows_without_progress(social, record_of, straight_line):
    """10 s ahead, 10 s to and fro, 10 s ahead, and a rest that fills no window."""
    there = straight_line(length=5.0)[:-1]
    wait = np.zeros((100, 3)) + there[-1]
    wait[:, 0] += 0.04 * np.sin(np.arange(100))
    poses = np.vstack((there, wait, there + np.array((5.0, 0.0, 0.0)), there[:20] + np.array((10.0, 0.0, 0.0))))
    assert social["failure_to_progress"](record_of(poses)) == 2.0
    assert math.isnan(social["failure_to_progress"](record_of(poses[:30])))


def test_stalled_time_counts_neither_driving_nor_turning(social, record_of):
    poses = np.zeros((41, 3))
    poses[11:21, 2] = np.linspace(0.1, 1.0, 10)
    poses[21:, 2] = 1.0
    poses[31:, 0] = np.linspace(0.05, 0.5, 10)
    record = record_of(poses)
    assert social["stalled_time"](record) == pytest.approx(2.0, abs=0.15)


def test_completion_is_the_share_of_the_first_path(social, record_of, straight_line):
    path = {"path_poses": straight_line(length=8.0), "path_offsets": [0, 161], "path_stamps": [0.0]}
    half = record_of(straight_line(length=4.0), meta={"outcome": "time_out"}, **path)
    assert social["completion"](half) == pytest.approx(0.5)
    assert social["timeout"](half) == 1.0
    assert social["completion"](record_of(straight_line(length=4.0), **path)) == 1.0  # it has arrived
    assert social["goal_distance_min"](half) == 0.0


def test_places_are_projected_on_a_path():
    path = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 0.0), (2.0, 2.0)])
    assert along_path(path, np.array([(1.0, 0.5), (3.0, 1.0), (2.0, 9.0), (-1.0, 0.0)])).tolist() == [
        1.0,
        3.0,
        4.0,
        0.0,
    ]


def test_a_person_touched_again_is_one_person(social, record_of, straight_line):
    touched = {"contact_stamp": [1.0, 2.0, 3.0, 4.0], "contact_kind": [2, 2, 2, 0], "contact_person": [4, 4, 7, 0]}
    touched |= {"contact_speed": [0.1] * 4, "contact_caused": [True] * 4, "contact_position": [[0, 0]] * 4}
    assert social["people_touched"](record_of(straight_line(), **touched)) == 2.0


def test_the_goal_is_plain_sooner_the_sooner_the_robot_turns_to_it(social, preset_of, record_of):
    pack = SocialMetrics(**{**preset_of("social"), "other_goals": ((4.0, -2.0),)})
    legible = next(metric.compute for metric in pack.metrics() if metric.name == "legibility")
    direct = np.stack((np.linspace(0, 4, 81), np.linspace(0, 2, 81), np.zeros(81)), axis=1)
    late = np.stack((np.linspace(0, 4, 81), np.maximum(np.linspace(-6, 2, 81), 0), np.zeros(81)), axis=1)
    assert 0.5 < legible(record_of(late)) < legible(record_of(direct)) < 1.0
    assert math.isnan(social["legibility"](record_of(direct)))


@pytest.mark.parametrize("goals", [[[4.0]], [[4.0, math.inf]], [[1.0, 2.0, 3.0]]])
def test_goals_that_are_no_places_are_refused(preset_of, goals):
    with pytest.raises(ConfigurationError, match="other_goals holds"):
        SocialMetrics(**{**preset_of("social"), "other_goals": goals})


def hunav_force(own, own_velocity, other, other_velocity):
    """Return the force of another on one as the paper writes it, one pair at a time (Moussaid et al. 2009)."""
    to_other = np.subtract(other, own)
    distance = math.hypot(*to_other)
    e = to_other / distance
    d = 2.0 * np.subtract(own_velocity, other_velocity) + e
    size = math.hypot(*d)
    t, n = d / size, np.array((-d[1], d[0])) / size
    theta = math.atan2(t[1], t[0]) - math.atan2(e[1], e[0])
    theta = (theta + math.pi) % (2.0 * math.pi) - math.pi
    b = 0.35 * size
    f = -math.exp(-distance / b - (3.0 * b * theta) ** 2) * t
    return 2.1 * (f + math.copysign(1.0, theta) * (theta != 0.0) * math.exp(-distance / b - (2.0 * b * theta) ** 2) * n)


def hunav_sums(record):
    """Return social work, force and space shares summed row by row, as HuNavSim's evaluator does (2025)."""
    work = force = 0.0
    inside = dict.fromkeys(("intimate", "personal", "social"), 0)
    radius, distances = record.meta["robot"]["footprint"]["radius"], []
    for k in range(len(record["stamp"])):
        x, y, theta = record["pose"][k]
        vx, vy, _ = record["twist"][k]
        own = (vx * math.cos(theta) - vy * math.sin(theta), vx * math.sin(theta) + vy * math.cos(theta))
        joint, sizes, gaps = np.zeros(2), 0.0, []
        for p, body in enumerate(record["pedestrian_radii"]):
            place, velocity = (record[f"pedestrian_{name}"][k, p].astype(float) for name in ("positions", "velocities"))
            if np.isnan(place).any():
                continue
            one = hunav_force((x, y), own, place, velocity)
            joint, sizes = joint + one, sizes + math.hypot(*one)
            gaps.append(max(math.dist((x, y), place) - radius - body, 0.0))
        work, force = work + math.hypot(*joint) + sizes, force + sizes
        distances += [min(gaps)] if gaps else []
        for name, low, high in (("intimate", 0, 0.45), ("personal", 0.45, 1.2), ("social", 1.2, 3.6)):
            inside[name] += bool(gaps) and low <= min(gaps) < high
    rows = len(record["stamp"])
    return work, force, {name: count / rows for name, count in inside.items()}, float(np.mean(distances))


def recorded(record_of):
    """Return a round robot that winds between people who walk, one of whom vanishes."""
    time = 0.1 * np.arange(201)
    poses = np.stack((0.4 * time, np.sin(0.4 * time), np.arctan2(0.4 * np.cos(0.4 * time), 0.4)), axis=1)
    walks = [
        (6.0 - 0.5 * time, 0.4 + 0 * time),
        (3.0 + 0 * time, 2.0 - 0.2 * time),
        (0.3 * time - 1.0, -1.0 + 0.1 * time),
    ]
    people = np.stack([np.stack(walk, axis=1) for walk in walks], axis=1)
    people[120:, 1] = np.nan
    return among(record_of, poses, people)


def test_forces_and_shares_are_those_of_the_formulas_written_for_one_pair_at_a_time(social, record_of):
    record = recorded(record_of)
    work, force, shares, distance = hunav_sums(record)
    assert social["social_work"](record) == pytest.approx(0.1 * work, rel=0.01)  # per step there, per second here
    assert social["social_force"](record) == pytest.approx(0.1 * force, rel=0.01)
    for name, share in shares.items():
        assert social[f"{name}_share"](record) == pytest.approx(share, abs=0.02)
    assert social["people_distance_mean"](record) == pytest.approx(distance, rel=0.01)


def test_forces_repel_and_are_opposite():
    away, closing = np.array([(1.0, 0.2)]), np.array([(0.5, 0.1)])
    force = social_force(away, closing)
    assert (force * away).sum() < 0.0
    assert social_force(-away, -closing) == pytest.approx(-force)
    assert (social_force(np.zeros((1, 2)), closing) == 0.0).all()


def changed(record, arrays, goal):
    scenario = {**record.meta["scenario"], "goal": goal}
    return EpisodeRecord({**record.arrays, **arrays}, {**record.meta, "scenario": scenario})


def same(social, one, other, names=None):
    for name, compute in social.items():
        pair = compute(one), social[(names or {}).get(name, name)](other)
        assert pair[1] == pytest.approx(pair[0], rel=1e-4, abs=1e-5, nan_ok=True), name


def test_a_mirror_changes_nothing_but_the_sides(social, record_of):
    record, flip = recorded(record_of), np.array((1.0, -1.0))
    goal = [*(record["pose"][-1, :2] * flip), 0.0]
    arrays = {name: record[name] * (1.0, -1.0, -1.0) for name in ("pose", "twist")}
    arrays |= {name: record[name] * flip for name in ("pedestrian_positions", "pedestrian_velocities")}
    start = {"start": [*(record["pose"][0, :2] * flip), 0.0]}
    mirrored = changed(record, arrays, goal)
    mirrored = EpisodeRecord(mirrored.arrays, {**mirrored.meta, "scenario": {**mirrored.meta["scenario"], **start}})
    same(social, record, mirrored, MIRRORED)


def test_a_later_clock_changes_nothing(social, record_of):
    record = recorded(record_of)
    same(social, record, changed(record, {"stamp": record["stamp"] + 100.0}, record.meta["scenario"]["goal"]))


def test_twice_as_fine_steps_change_little(social, record_of):
    """Integrals over time are those of time, not of steps."""
    record = recorded(record_of)
    coarse = {name: array[::2] if len(array) == 201 else array for name, array in record.arrays.items()}
    for name in ("social_work", "proxemic_intrusion", "personal_space_cost", "motion_energy", "people_distance_mean"):
        rough = social[name](EpisodeRecord(coarse, record.meta))
        assert rough == pytest.approx(social[name](record), rel=0.03), name


def test_nobody_there_and_a_single_row_are_no_error(social, record_of, straight_line):
    empty, single = record_of(straight_line()), record_of([(0.0, 0.0, 0.0)])
    vanished = among(record_of, straight_line(), np.full((81, 2, 2), np.nan))
    for record in (empty, vanished):
        assert math.isnan(social["personal_share"](record))
        assert math.isnan(social["space_compliance"](record))
        assert math.isnan(social["min_predicted_distance"](record))
        assert math.isnan(social["topological_complexity"](record))
        assert social["proxemic_intrusion"](record) == social["social_work"](record) == 0.0
        assert social["near_misses"](record) == social["passes_left"](record) == 0.0
    found = {name: compute(single) for name, compute in social.items()}
    assert all(math.isnan(value) or value >= 0.0 for value in found.values())


def test_a_missing_array_leaves_a_cell_empty(record_of, straight_line, preset_of):
    packs = build_metrics({"metrics": {"social": {"name": "social", **preset_of("social")}}}, load_registry())
    unknown = {"unknown": {"pedestrian_velocities": "a recording without"}, "columns": {}}
    row = evaluate_record(record_of(straight_line(), meta=unknown), packs)
    assert math.isnan(row["social.social_work"])
    assert row["social.heading_change"] == 0.0
