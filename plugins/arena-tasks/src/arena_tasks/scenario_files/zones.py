"""Zones of a scenario: where the robot has to come for a person to start."""

from __future__ import annotations

from arena_core import PedestrianSpec

MOST = 8  # zones of a person


def zones_of(person: PedestrianSpec) -> list[tuple[float, float, float]]:
    """Return x, y and radius (m, in ``map``) of a person's trigger zones; none for one who starts by itself."""
    if person.behaviour.get("start_up_mode") != "trigger_zone":
        return []
    x, y = person.position_xy.tolist()
    first = _read_zone(person, "trigger_zone", x, y)
    others = [_read_zone(person, f"trigger_zone_{number}", x, y) for number in range(2, MOST + 1)]
    return [zone for zone in (first, *others) if zone[2] > 0.0]


def _read_zone(person: PedestrianSpec, name: str, x: float, y: float) -> tuple[float, float, float]:
    """Return a zone; around where the person starts unless said otherwise, with radius 0 where there is none."""
    said = [person.behaviour.get(f"{name}_{what}", usual) for what, usual in (("x", x), ("y", y), ("radius", 0.0))]
    there, up, radius = (value if isinstance(value, int | float) else 0.0 for value in said)
    return float(there), float(up), float(radius)
