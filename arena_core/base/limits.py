"""How much the suite takes in: what lies beyond is refused in one line, at once (docs/limits.md).

The limits are many times what anybody was seen to need, and small enough that no input takes a machine's memory or
minutes of its time.
"""

from __future__ import annotations

from dataclasses import dataclass, fields


@dataclass(frozen=True, slots=True)
class Limits:
    """Every limit, with its unit in its name; ``LIMITS`` is the only one of its kind."""

    # numbers of the configuration and of files
    number_largest: float = 1e6  # of any number, whatever its unit: a thousand kilometres, twelve days
    number_smallest: float = 1e-9  # of any number that has to be above 0: below, quotients leave the range of floats
    whole_largest: int = 2**63 - 1  # what arrays of whole numbers hold
    episodes: int = 100_000  # of one run: a day and a night at a second each
    workers: int = 1024
    robots: int = 200  # of a team
    beams: int = 10_000  # of a lidar; those of robots have up to 2,000
    folder_parts: int = 64  # folders inside each other that a run's folder may lie in
    samples: int = 1_000  # of what is tried at every control step, of waypoints drawn, of tries
    cells: int = 50_000_000  # of a map: 350 m by 350 m at 5 cm

    # files, in bytes; those of gzip files once unpacked
    yaml_bytes: int = 200_000  # a map's has 200, a pack's a few thousand; PyYAML reads 100 kB a second
    yaml_depth: int = 100  # brackets inside each other
    yaml_nodes: int = 100_000  # values of a configuration file once its aliases are written out
    json_bytes: int = 10_000_000  # scenarios, cards, provenance
    xml_bytes: int = 20_000_000  # BARN's worlds have 0.5 million
    xml_elements: int = 1_000_000  # 100,000 boxes with all that belongs to them
    xml_depth: int = 100  # elements inside each other
    source_bytes: int = 1_000_000  # of a plugin that moves a model
    walls_bytes: int = 20_000_000  # rows of x1 y1 x2 y2
    walls: int = 500_000  # of them
    tracks_bytes: int = 50_000_000  # recorded people
    tracks_rows: int = 2_000_000
    table_bytes: int = 100_000_000  # an episodes.csv
    image_bytes: int = 200_000_000  # a picture of a map
    network_bytes: int = 64 * 2**20  # an ONNX file
    arrays_bytes: int = 500_000_000  # of one .npy or .npz file once unpacked: records, maps, roll-outs, reference paths

    # what records hold
    record_seconds: float = 1e5  # from the first stamp to the last: a day and four hours
    record_metres: float = 1e5  # that the robot drives
    record_farthest: float = 1e7  # m from the origin of a map: the earth's coordinates in metres (UTM) lie within

    # what files hold
    elements: int = 10_000  # of one list: problems, obstacles, corners, waypoints
    people: int = 1_000  # of a problem
    obstacles: int = 10_000  # of a problem
    doors: int = 100  # of a problem
    furniture: int = 1_000  # of a problem; a piece has some ten solids
    body_extent: float = 1_000.0  # m, of an obstacle or a person
    drawn_cells: int = 500_000_000  # that solids or obstacles cover, each counted for itself


LIMITS = Limits()
NAMES = tuple(field.name for field in fields(Limits))
