"""Lidars see people on two legs where the model says so; contacts, and whatever else is true, are those of discs."""

from collections.abc import Sequence

import numpy as np
import pytest

from arena_core import OccupancyGrid, PedestrianSpec, Pose, Scenario, Simulator, Snapshot, World
from arena_core.config.configuration import compose, to_plain
from arena_core.config.registry import load_registry

HALL = np.zeros((160, 160), np.int8)
HALL[:2] = HALL[-2:] = HALL[:, :2] = HALL[:, -2:] = 100
GRID = OccupancyGrid(HALL, 0.05, Pose(0.0, 0.0))
STEP = 0.1


def simulator(body: str, preset: str = "social_force") -> Simulator:
    config = to_plain(
        compose(
            [
                "planner=dwa",
                "robot=jackal",
                "robot.lidar.noise_std=0",
                f"pedestrians={preset}",
                f"pedestrians.body={body}",
            ]
        )
    )
    registry = load_registry()
    robot = registry.build("robot", config["robot"])
    crowd = registry.build("pedestrians", config["pedestrians"])
    built: Simulator = registry.build("simulator", config["simulator"], robot=robot, pedestrians=crowd)
    return built


def person(
    number: int, x: float, y: float, *way: tuple[float, float], speed: float = 1.0, **behaviour: float | str
) -> PedestrianSpec:
    return PedestrianSpec(number, np.array((x, y)), np.array(way).reshape(-1, 2), speed, 0.3, dict(behaviour))


def scene(name: str, *people: PedestrianSpec) -> Scenario:
    return Scenario(name, 0, World("hall", GRID), Pose(2.0, 4.0), Pose(7.0, 4.0), people, (), 0.3, 60.0)


def advance(
    sim: Simulator, scenarios: Sequence[Scenario], seconds: float, command: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> Snapshot:
    snapshot = sim.reset(scenarios)
    for _ in range(round(seconds / STEP)):
        snapshot = sim.advance(np.tile(command, (len(scenarios), 1)), round(STEP / sim.inner_step))
    return snapshot


def arcs(snapshot: Snapshot, slot: int, nearer: float) -> list[int]:
    """Return how many neighbouring beams each thing nearer than so many metres sends back."""
    hit = snapshot.ranges[slot] < nearer
    edges = np.flatnonzero(np.diff(np.concatenate(([False], hit, [False])).astype(int)))
    return [int(end - begin) for begin, end in edges.reshape(-1, 2)]


def test_scan_of_a_person_who_stands_shows_two_arcs_or_one() -> None:
    scenes = [scene(name, person(0, 3.5, 4.0)) for name in "abcde01234567"]
    legs, discs = (advance(simulator(body), scenes, 0.5) for body in ("legs", "discs"))
    found = [len(arcs(legs, slot, 1.8)) for slot in range(len(scenes))]
    assert set(found) <= {1, 2}  # one leg may hide the other
    assert found[5:].count(2) >= 4
    assert [len(arcs(discs, slot, 1.8)) for slot in range(len(scenes))] == [1] * len(scenes)


def test_legs_send_fewer_returns_than_the_body_and_none_from_outside_it() -> None:
    people = (person(0, 3.5, 4.0, (3.5, 6.0), (3.5, 2.0)), person(1, 4.0, 3.0))
    discs, legs = (advance(simulator(body), [scene("one", *people)], 1.2) for body in ("discs", "legs"))
    assert (discs.crowd.positions == legs.crowd.positions).all()
    assert (legs.ranges >= discs.ranges - 1e-6).all()
    assert 0 < sum(arcs(legs, 0, 2.6)) < 0.6 * sum(arcs(discs, 0, 2.6))


def test_phase_advances_with_the_way_and_not_with_time() -> None:
    sim = simulator("legs")
    advance(sim, [scene("stands", person(0, 3.5, 4.0))], 0.0)
    seen = [sim.advance(np.zeros((1, 3)), round(STEP / sim.inner_step)).ranges.copy() for _ in range(10)]
    assert all((ranges == seen[0]).all() for ranges in seen)
    slow, fast = (simulator("legs") for _ in range(2))
    advance(slow, [scene("walks", person(0, 4.0, 2.0, (4.0, 7.0), speed=0.5))], 6.0)
    advance(fast, [scene("walks", person(0, 4.0, 2.0, (4.0, 7.0), speed=1.0))], 3.0)
    ways, steps = zip(*(_walked(sim) for sim in (slow, fast)), strict=True)
    assert ways[0] == pytest.approx(ways[1], rel=0.2)
    assert ways[0] / steps[0] == pytest.approx(np.sqrt(0.39 * 0.5), rel=0.2)
    assert ways[1] / steps[1] == pytest.approx(np.sqrt(0.39 * 1.0), rel=0.2)


def _walked(sim: Simulator) -> tuple[float, float]:
    """Return how far the first person has come, m, and in how many steps (the first part of one is drawn)."""
    row = sim._worlds.people[0, 0]  # type: ignore[attr-defined]
    drawn = simulator("legs")
    drawn.reset([scene("walks", person(0, 4.0, 2.0, (4.0, 7.0)))])
    first = drawn._worlds.people[0, 0]  # type: ignore[attr-defined]
    return float(row["y"] - 2.0), float(row["steps"] - first["steps"])


def test_contacts_and_clearances_are_those_of_discs() -> None:
    people = (person(0, 3.5, 4.0),)
    discs, legs = (
        advance(simulator(body), [scene("bump", *people)], 3.0, (0.5, 0.0, 0.0)) for body in ("discs", "legs")
    )
    assert legs.in_contact[0]
    assert (discs.poses == legs.poses).all()
    assert (discs.clearances_people == legs.clearances_people).all()
    assert legs.ranges.min() > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("preset", ["social_force", "orca"])
def test_world_k_of_many_is_what_it_is_alone(preset: str) -> None:
    scenes = [
        scene("one", person(0, 3.5, 4.0, (6.0, 4.0), (3.5, 5.5))),
        scene(
            "two",
            person(0, 3.0, 3.0),
            person(1, 5.0, 5.0, (5.0, 2.0), (5.0, 6.5), speed=1.3),
            person(2, 6.0, 6.0, (3.0, 6.0)),
        ),
        scene("none"),
    ]
    together = advance(simulator("legs", preset), scenes, 4.0, (0.2, 0.0, 0.1))
    for k, one in enumerate(scenes):
        alone = advance(simulator("legs", preset), [one], 4.0, (0.2, 0.0, 0.1))
        assert together.ranges[k].tobytes() == alone.ranges[0].tobytes()
    again = simulator("legs", preset)
    advance(again, scenes, 2.0)
    begun = again.reset([scenes[1]], np.array([0]))
    assert begun.ranges[0].tobytes() == simulator("legs", preset).reset([scenes[1]]).ranges[0].tobytes()


def test_forklifts_have_no_legs() -> None:
    truck = person(0, 4.5, 4.0, type="forklift")
    discs, legs = (advance(simulator(body), [scene("truck", truck)], 0.5) for body in ("discs", "legs"))
    assert (discs.ranges == legs.ranges).all()


def test_recorded_people_come_and_go_on_their_legs() -> None:
    sim = simulator("legs", "replay")
    snapshot = advance(sim, [scene("replay")], 20.0)
    assert np.isfinite(sim._worlds.people["leg_vx"]).all()  # type: ignore[attr-defined]
    assert (snapshot.ranges > 0.0).all()
