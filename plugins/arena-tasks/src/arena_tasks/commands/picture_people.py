"""People of a scenario on a picture: where they start, their rounds, groups and trigger zones."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from arena_core import PedestrianSpec
from arena_drawing.painter import INK
from arena_tasks.scenario_files.zones import zones_of

# after Okabe and Ito, then those of the viewer
GROUPS = ("#CC79A7", "#8E44AD", "#B7950B", "#117A65", "#56B4E9", "#C0392B")
TRIGGER = "#56B4E9"


def group_colours(people: Iterable[PedestrianSpec]) -> dict[str, str]:
    """Return a colour for each group, in the order in which they come."""
    names = dict.fromkeys(str(person.behaviour["group"]) for person in people if person.behaviour.get("group"))
    return {name: GROUPS[number % len(GROUPS)] for number, name in enumerate(names)}


def draw_person(axes: Axes, person: PedestrianSpec, colour: str) -> None:
    """Draw a person, numbered and with a type that is not adult, its round and its trigger zones."""
    x, y = person.position_xy.tolist()
    for zone in zones_of(person):
        disc = Circle(zone[:2], zone[2])
        disc.set(facecolor=TRIGGER, alpha=0.18, edgecolor=TRIGGER, linestyle=":", linewidth=1.2, zorder=1.5)
        axes.add_patch(disc)
        axes.plot([x, zone[0]], [y, zone[1]], ":", color=TRIGGER, linewidth=1.0, zorder=2)
    _draw_patrol_route(axes, person, colour)
    axes.add_patch(Circle((x, y), person.radius, facecolor=colour, edgecolor="white", linewidth=0.6, zorder=4))
    kind = str(person.behaviour.get("type", "adult"))
    text = str(person.id) if kind == "adult" else f"{person.id} {kind}"
    beside = (x + 0.75 * person.radius, y + 0.75 * person.radius)
    plate = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.8}
    axes.annotate(text, beside, (2, 2), textcoords="offset points", fontsize=8, color=INK, zorder=7, bbox=plate)


def _draw_patrol_route(axes: Axes, person: PedestrianSpec, colour: str) -> None:
    """Draw the way to the first waypoint and the loop of all of them; whoever has none stands."""
    if not len(person.waypoints_xy):
        return
    loop = np.vstack((person.waypoints_xy, person.waypoints_xy[:1]))
    way = np.vstack((person.position_xy[None], loop))
    axes.plot(*way.T, "--", color=colour, linewidth=1.0, alpha=0.9, zorder=2)
    axes.plot(*person.waypoints_xy.T, "s", color=colour, markersize=3.5, zorder=3)
